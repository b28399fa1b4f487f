#pragma once

#include <span>

#include "render/base/image.h"
#include "render/light/sources.h"
#include "render/medium/medium.h"

/// Plain implementations of the work that takes most of the time of a run, without SIMD, tables or transforms. The
/// speed of the program is compared with the speed of these implementations in the same process.
namespace gladstone::bench {

/// Plain implementation to which the renderer's steps per second are compared: one ray at a time, 64 terms in a triple
/// loop for the value and the three derivatives, and Sharma's RK4.
struct PlainRay {
  Vec3d position;   ///< position [m]
  Vec3d direction;  ///< optical direction, n dR/ds [1]
};

/// Advances a ray by a number of steps of dt = step/n.
PlainRay plain_steps(SplineVolume<double> const& volume, Ray<double> const& start, double step, int steps);

/// Finds the displacement of every window of 32 px at an overlap of 50 % by direct correlation: the shift of up to 8 px
/// along either axis with the largest sum of products of the grey levels minus their means.
/// @return number of windows for which a shift was found
int plain_correlation(Image<double> const& first, Image<double> const& second);

/// Draws Gaussian particle images integrated over the pixels, by the error function at the edges of each pixel.
/// @param places  centres of the images [px]
/// @param sigma   standard deviation of the images [px]
Image<double> plain_images(std::span<Vec2d const> places, double sigma, int columns, int rows);

}  // namespace gladstone::bench
