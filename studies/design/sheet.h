#pragma once

#include <string>
#include <vector>

#include "studies/case.h"
#include "studies/design/bench.h"

namespace gladstone {

/// How a value of the sheet stands against what is usually asked of it.
enum class Margin {
  none,      ///< nothing is asked
  green,     ///< kept with room
  marginal,  ///< kept, or missed, by little
  violated,
};

/// "green", "marginal", "violated", or nothing.
char const* margin_word(Margin margin);
/// Of a value that is to be large: green from `good` on, violated below `least`.
Margin at_least(double value, double good, double least);
/// Of a value that is to be small: green up to `good`, violated above `most`.
Margin at_most(double value, double good, double most);

/// One closed form of the design sheet.
struct SheetRow {
  std::string id;   ///< its number in docs/design.md, F1 to F27
  std::string key;  ///< for programs, with its unit as suffix
  std::string name;
  double value;  ///< in `unit`; NaN: it does not apply
  std::string unit;
  std::string formula;
  std::string source;
  Margin margin = Margin::none;
  std::string note;  ///< what the margin is of, or what else is to be known
};

/// The closed forms that describe a setup, in the order of their numbers.
struct DesignSheet {
  std::vector<SheetRow> rows;

  /// The row of a key. @pre it is there
  SheetRow const& row(std::string const& key) const;
  double operator[](std::string const& key) const { return row(key).value; }
};

/// What a BOS setup gives its bench, its largest gradient among it. @throws DataError of a field that cannot be read
BenchGiven bench_given(CaseSetup const& loaded);
/// The bench of a setup; `given` must outlive it.
Bench<double> bench_of(Setup const& setup, BenchGiven const& given);

/// What closed forms leave out of a setup, as warnings: dots out of focus, a posed camera, windows.
std::vector<std::string> beyond_closed_forms(Setup const& setup);

/// The gradient that the sheet's displacements are of: the largest in view, or 10 kg/m^4 where there is none.
double shown_gradient(BenchGiven const& given);

/// In what a bench lies beyond the study that the random error (F26) was fitted to: "dots below 0.8 px, ..."; empty:
/// within.
std::string beyond_study(Bench<double> const& bench);

/// Sheet of a BOS bench: F1 to F27. Gradients and deflections for which none is given are of 10 kg/m^4.
DesignSheet bos_sheet(Setup const& setup, Bench<double> const& bench);

/// Sheet of a PIV setup: imaging, particle images, how many a window, light, and how far particles may move.
/// @throws DataError of a file of particles @pre loaded.setup.piv
DesignSheet piv_sheet(CaseSetup const& loaded);

}  // namespace gladstone
