#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone {

/// Standard deviation of the Gaussian average in which regions are sought, not of what is measured [px].
inline constexpr double dot_smoothing_px = 0.8;

/// A connected region of a picture that looks like a dot.
struct DotRegion {
  Vec2d centre{};     ///< [px]
  double radius = 0;  ///< of the disc of its area at half its height [px]
  double window = 0;  ///< radius of the window for its centroid [px]
};

/// The regions of a picture that stand out from its background.
struct DotRegions {
  std::vector<DotRegion> dots;
  std::vector<Vec2d> others;      ///< centres of regions that have neither the size nor the shape of the dots
  Image<unsigned char> not_dots;  ///< 255 where a region is no dot
};

/// Finds the regions that look like dots.
/// - Height: above a quarter of the dots' height, which is the median over area of what exceeds the noise eight times.
/// - Size: area at half the height within a factor 3 of the usual one.
/// - Shape: a filled ellipse (its area is 4 pi sqrt(det M) of its second moments M, and less for every other shape), of
///   about the usual ratio of axes, which the camera's slant sets.
/// Regions that touch the picture's edge are neither.
/// @param levels over the background, dots bright @param noise standard deviation of a level
DotRegions find_dot_regions(Image<double> const& levels, double noise);

}  // namespace gladstone
