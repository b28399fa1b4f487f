#pragma once

#include <cstddef>
#include <vector>

#include "analysis/correlation/lane_correlation.h"
#include "analysis/correlation/window_measurement.h"

namespace gladstone::inline correlation {

/// Sums over image pairs of the correlation planes of all windows of a grid, for ensemble correlation (Meinhart,
/// Wereley & Santiago, J. Fluids Eng. 122 (2000) 285). The planes are correlation coefficients, so that all pairs have
/// equal weight regardless of their illumination.
class PlaneSums {
 public:
  /// @param windows  number of windows of the grid
  /// @param radius  largest shift searched [px], as in InterrogationJob
  PlaneSums(std::size_t windows, int radius);

  /// Adds the planes of windows first .. first + count - 1 of one pair and replaces them by the mean over all pairs so
  /// far. Different windows may be added concurrently.
  /// @param outcome  outcome of each window for this pair; set to measured if the window was measured in any pair so
  /// far
  void add(std::size_t first, int count, LanePlane& plane, WindowCorrelation::Outcome* outcome);

 private:
  std::size_t plane_size_;
  std::vector<float> sums_;    // sums of the planes [window][plane value]
  std::vector<int> measured_;  // number of pairs summed for each window
};

}  // namespace gladstone::inline correlation
