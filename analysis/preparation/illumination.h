#pragma once

#include "render/base/image.h"

namespace gladstone::inline preparation {

/// Estimates the smoothly varying background of an image of dots. Computes the medians of blocks whose side is an
/// eighth of the image's shorter side (at least 16 px), interpolates them linearly between the block centres and
/// extrapolates to the edges. Valid if dots cover less than half of every block.
Image<double> estimate_background(Image<double> const& levels);

}  // namespace gladstone::inline preparation
