#pragma once

#include <optional>
#include <vector>

#include "studies/budget_stages.h"
#include "studies/design/simulation.h"

namespace gladstone {

/// What is kept of the repeats of one medium, at the vectors of the grid.
struct Repeats {
  std::vector<Vec2d> place, eq9;
  std::vector<std::vector<Vec2d>> error;         ///< of each: measured less Eq. 9; NaN where one does not count
  std::vector<std::vector<BudgetStage>> causes;  ///< of each: budget_differences()
  std::vector<Vec2d> cone, refraction, lens;     ///< displacements of the first
  double displacement_px = 0;
  std::optional<Setup> setup;
  double magnification = 0;
  std::optional<std::uint64_t> rays;  ///< that correct a plain table; nothing where dots take what they need
};

/// Adds a case to its medium's repeats. @param border around the picture where vectors do not count [px]
void enter(Repeats& repeats, ObservedCase const& seen, double border);

/// Random and systematic error over repeats, after RepeatSplit; the systematic one's error in the limit of many
/// windows: its square has a standard deviation of sqrt((v^2 + 2 b^2 v) / n), v the variance of a mean over repeats,
/// n = 2 N components over independent windows.
void add_errors(SimulatedBench& bench, Repeats const& repeats, Bench<double> const& formulas);

/// What a wave has left. @param wavelength [m] @param window_px the last pass's
WaveShares shares_of(Repeats const& repeats, double wavelength, int window_px);

}  // namespace gladstone
