#pragma once

#include <opencv2/core.hpp>

namespace gladstone {

/// Background of a picture of dots as light that falls off smoothly leaves it: medians of blocks an eighth of the
/// picture's shorter side wide (at least 16 px), interpolated linearly between the blocks' centres and extrapolated to
/// the edges. Holds where dots cover less than half of every block.
/// @param levels grey levels, CV_64F
cv::Mat estimate_background(cv::Mat const& levels);

/// Median of all values, CV_64F.
double median_level(cv::Mat const& values);

}  // namespace gladstone
