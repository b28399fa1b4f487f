#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline calibration {

/// Standard deviation of the Gaussian filter applied before the region search [px]. Centroids are measured in the
/// unfiltered image.
inline constexpr double dot_smoothing_px = 0.8;

/// Connected region of an image with the size and shape of a dot.
struct DotRegion {
  Vec2d centre{};     ///< centre of the region in which the level exceeds half the dot's peak height [px]
  double radius = 0;  ///< radius of a disc of the same area as the region above half the peak height [px]
  double window = 0;  ///< radius of the window in which the centroid is computed [px]
};

/// Regions of an image that exceed its background.
struct DotRegions {
  std::vector<DotRegion> dots;
  std::vector<Vec2d> others;      ///< centres of regions that differ from the dots in size or shape [px]
  Image<unsigned char> not_dots;  ///< 255 inside every region that is not a dot, else 0
};

/// Finds the regions that have the size and shape of the dots.
/// - Height: the peak level exceeds a quarter of the dots' usual height, which is the area-weighted median of the peak
///   levels of all regions that exceed eight times the noise.
/// - Size: area at half height within a factor of 3 of the median area.
/// - Shape: a filled ellipse whose axis ratio is close to the median axis ratio of the regions; the median depends on
///   the camera's viewing angle. The area of an ellipse is 4 pi sqrt(det M) for its second moments M; every other shape
///   has a smaller area.
/// Regions that touch the image's edge are reported neither as dots nor in `others`.
/// @param levels  grey levels above the background, with bright dots
/// @param noise   standard deviation of the grey levels
DotRegions find_dot_regions(Image<double> const& levels, double noise);

}  // namespace gladstone::inline calibration
