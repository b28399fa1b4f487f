#pragma once

#include <optional>
#include <vector>

#include "studies/compare/budget_stages.h"
#include "studies/design/simulation.h"

namespace gladstone::inline design {

/// Results of all repeats with one medium, at the vectors of the lattice.
struct Repeats {
  std::vector<Vec2d> place, eq9;
  /// measurement minus Eq. 9 of each repeat [px]; NaN at invalid vectors
  std::vector<std::vector<Vec2d>> error;
  std::vector<std::vector<BudgetStage>> causes;  ///< budget_differences() of each repeat
  std::vector<Vec2d> cone, refraction, lens;     ///< displacements in the first repeat [px]
  double displacement_px = 0;
  std::optional<Setup> setup;
  double magnification = 0;
  /// rays per dot that correct the deflection table; empty without a table of single fineness, or if chosen per dot
  std::optional<std::uint64_t> rays;
};

/// Adds a case to the repeats of its medium.
/// @param border  width of the margin in which vectors are excluded [px]
void enter(Repeats& repeats, ObservedCase const& seen, double border);

/// Computes random and systematic error over the repeats by RepeatSplit. In the limit of many windows, the square of
/// the systematic error has a standard deviation of sqrt((v^2 + 2 b^2 v) / n), with v the variance of a mean over
/// repeats and n = 2 N components in N independent windows.
void add_errors(SimulatedDesign& bench, Repeats const& repeats, DesignPoint<double> const& formulas);

/// Computes the amplitude of a wave after each stage.
/// @param wavelength  of the density wave [m]
/// @param window_px   size of the last pass's interrogation window [px]
WaveShares compute_wave_shares(Repeats const& repeats, double wavelength, int window_px);

}  // namespace gladstone::inline design
