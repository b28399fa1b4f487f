#pragma once

#include "render/base/image.h"

namespace gladstone {

/// Background of a picture of dots as light that falls off smoothly leaves it: medians of blocks an eighth of the
/// picture's shorter side wide (at least 16 px), interpolated linearly between the blocks' centres and extrapolated to
/// the edges. Holds where dots cover less than half of every block.
Image<double> estimate_background(Image<double> const& levels);

}  // namespace gladstone
