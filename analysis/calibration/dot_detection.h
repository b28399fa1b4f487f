#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone {

/// A dot as a picture shows it.
struct DetectedDot {
  Vec2d centre_px{};       ///< column right, row down, from the first pixel's centre
  double flux = 0;         ///< grey levels over the background, summed
  double diameter_px = 0;  ///< of the disc of its area at half its height
};

/// What a picture of a calibration target shows.
struct DetectedDots {
  std::vector<DetectedDot> dots;  ///< in no order
  std::vector<Vec2d> not_dots;    ///< centres of regions without the size and shape of the dots: dirt, letters [px]
};

/// Finds the dots of a calibration target, bright on dark or dark on bright.
///
/// Dots are connected regions that stand out from a background which may change smoothly over the picture (OpenCV;
/// find_dot_regions); dirt, letters and what touches the picture's edge is left out. A dot's centre is the centroid of
/// the grey levels over its background in a round window that holds the dot with its blur: unbiased wherever the dot
/// lies among the pixels, since nothing is cut off by a threshold, and for any shape (of tilted dots it is the centroid
/// of the image, not the image of the centre; PinholeModel knows). The background is the plane through a ring about the
/// window that no dot reaches; levels of dark dots are shares of it, so that light which falls off across a dot does
/// not move it. With N electrons in a dot of diameter d shot noise makes d / (4 sqrt(N)) px of it: 0.001 px for a dot
/// of 6 px and a full well of 30,000 electrons.
/// @return no dots where nothing stands out from the noise
DetectedDots detect_dots(Image<double> const& picture);

}  // namespace gladstone
