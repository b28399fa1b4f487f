#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline calibration {

/// Dot measured in an image of a calibration target.
struct DetectedDot {
  Vec2d centre_px{};       ///< centroid; column to the right, row downwards, from the centre of the first pixel
  double flux = 0;         ///< sum of the grey levels above the background (of dark dots: below it)
  double diameter_px = 0;  ///< diameter of a disc with the same area as the region in which the grey level exceeds half
                           ///< the dot's peak height [px]
};

/// Result of the dot detection in one image.
struct DetectedDots {
  std::vector<DetectedDot> dots;  ///< dots in no particular order
  /// Centres of regions that differ from the dots in size or shape, such as dirt and letters [px].
  std::vector<Vec2d> not_dots;
};

/// Detects the dots of a calibration target, bright on dark or dark on bright.
///
/// Dots are connected regions that differ from a smoothly varying background (OpenCV; find_dot_regions). Dirt, letters
/// and regions that touch the image's edge are excluded. The centre is the centroid of the grey levels above the
/// background in a circular window that contains the blurred dot. No threshold cuts off light, so the centre is
/// unbiased for every shape and sub-pixel position. For a tilted dot, the centroid of the dot's image differs from the
/// image of the dot's centre; see PinholeCamera::image_of_dot.
///
/// The background is a plane fitted to the pixels of a ring around the window that belong to no dot. If the ring has
/// few background pixels, or has them on one side only, a quadratic polynomial is fitted to the wider surroundings
/// instead. The levels of dark dots are taken relative to the background, so that uneven illumination across a dot does
/// not shift the centroid. For N electrons in a dot of diameter d, shot noise causes an error of d / (4 sqrt(N)) px:
/// 0.001 px for a dot of 6 px and a full well of 30,000 electrons.
/// @return no dots if no region exceeds the noise
DetectedDots detect_dots(Image<double> const& picture);

}  // namespace gladstone::inline calibration
