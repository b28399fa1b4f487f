#pragma once

#include <limits>

#include "render/light/sources.h"
#include "render/scene/truth_error.h"

namespace gladstone::inline rays {

/// Computes the truth of a source from the sums over its scramblings.
/// @param scramblings  number of scramblings; 0: no ray passes, the result is NaN
GLADSTONE_HD inline DotTruth source_truth(RaySums const* of_scramblings, int scramblings, Vec2d origin) {
  using std::sqrt;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  DotTruth truth;
  truth.origin = origin;
  truth.error = {nan, nan};
  RaySums all;
  for (int i = 0; i < scramblings; ++i) all += of_scramblings[i];
  for (int frame = 0; frame < frame_count; ++frame) truth.hits[frame] = all.hits[frame];
  if (scramblings > 1) {
    Vec2d const squares = displacement_error2(of_scramblings, scramblings, all);
    truth.error = {sqrt(squares.x), sqrt(squares.y)};
  }
  return truth;
}

/// Truth of one particle.
struct TracedParticleTruth {
  DotTruth truth;    ///< frames A and B, with the medium
  DotTruth ambient;  ///< frames A and B, without the medium
};

}  // namespace gladstone::inline rays
