#pragma once

#include <cstddef>
#include <vector>

#include "analysis/correlation/lane_correlation.h"
#include "analysis/correlation/window_measurement.h"

namespace gladstone {

/// Correlation planes of all windows of a grid, summed over pairs: ensemble correlation, Meinhart, Wereley & Santiago,
/// J. Fluids Eng. 122 (2000) 285. Planes are correlation coefficients before they are summed, so that pairs count alike
/// whatever their light.
class PlaneSums {
 public:
  /// @param windows of the grid @param radius largest shift looked for, as a job has it
  PlaneSums(std::size_t windows, int radius);

  /// Adds the planes of windows first .. first + count - 1 of a pair, and puts the mean of all so far in their place.
  /// Different windows may be added by different threads.
  /// @param outcome of each in this pair; afterwards measured where any pair was
  void add(std::size_t first, int count, LanePlane& plane, WindowCorrelation::Outcome* outcome);

 private:
  std::size_t plane_size_;
  std::vector<float> sums_;    // plane by plane
  std::vector<int> measured_;  // pairs in each
};

}  // namespace gladstone
