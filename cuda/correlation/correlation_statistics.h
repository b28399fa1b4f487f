#pragma once

#include "cuda/correlation/correlation_kernels.h"

/// Standard uncertainties by correlation statistics on the device; queued and checked as in correlation_kernels.h.
namespace gladstone::cuda::inline correlation {

/// Windows of the last pass on frames deformed by its vectors.
struct MatchedWindows {
  DevicePair pair;
  InterrogationGrid grid;
  AxisWeightsView x;
  AxisWeightsView y;
  int side;                   ///< side of the square of pixels with non-zero weight [px]
  int margin;                 ///< zero-weight pixels on either side of the square [px]
  GridVector const* vectors;  ///< uncertainties are estimated for valid vectors only
  double amplification;       ///< amplification_of_passes()
};

/// Returns the memory that a block needs for a window of this side [floats].
std::size_t statistics_values(int side);
/// Returns whether the memory for a window of this side exceeds the shared memory available to a block.
bool statistics_need_scratch(int side);

/// Estimates the standard uncertainty of every vector.
/// @param scratch  statistics_values(side) for each of `slots` concurrent windows; null if they fit into shared memory
/// @param variances  scratch, one per vector
/// @param sigma  output: standard uncertainty of each vector [px]; NaN if it is not valid or has no estimate
void estimate_sigma(MatchedWindows const& windows, float* scratch, int slots, Vec2d* variances, Vec2d* sigma);

}  // namespace gladstone::cuda::inline correlation
