#pragma once

#include "cuda/correlation/correlation_kernels.h"

/// Standard uncertainties by correlation statistics, on the device; queued and checked as correlation_kernels.h says.
namespace gladstone::cuda {

/// The windows of the last pass on frames that its vectors have deformed.
struct MatchedWindows {
  DevicePair pair;
  InterrogationGrid grid;
  AxisWeightsView x;
  AxisWeightsView y;
  int side;                   ///< of the pixels that have weight [px]
  int margin;                 ///< of the support, beside them
  GridVector const* vectors;  ///< of which the valid ones are asked for
  double amplification;       ///< amplification_of_passes()
};

/// Memory in which a block keeps what it needs of a window of that side [values].
std::size_t statistics_values(int side);
/// Whether that is more shared memory than a block can have.
bool statistics_need_scratch(int side);

/// @param scratch   statistics_values(side) for each of `slots` windows that are worked on together; null where they
///                  fit into shared memory
/// @param variances scratch, one for each vector
/// @param sigma     receives the standard uncertainty of each [px]; NaN where it is not valid or cannot be told
void estimate_sigma(MatchedWindows const& windows, float* scratch, int slots, Vec2d* variances, Vec2d* sigma);

}  // namespace gladstone::cuda
