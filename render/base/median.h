#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gladstone::inline base {

/// Standard deviation of a normal distribution over its median absolute deviation [1].
inline constexpr double sigma_per_median_deviation = 1.4826;

/// Returns the median of values; for an even number, the larger of the two middle values. Returns 0 for no values.
inline double upper_median(std::vector<double> values) {
  if (values.empty()) return 0;
  auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace gladstone::inline base
