#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone {

/// A dot as a picture shows it.
struct DetectedDot {
  Vec2d centre_px{};       ///< column right, row down, from the first pixel's centre
  double flux = 0;         ///< grey levels over the background, summed
  double diameter_px = 0;  ///< of the disc of the area that lies above the threshold
};

/// Finds the dots of a calibration target, bright on dark or dark on bright.
///
/// Dots are the connected regions above a quarter of the brightest (OpenCV); dust and what touches the picture's edge
/// is left out. A dot's centre is the centroid of the grey levels over its background in a round window that holds the
/// dot with its blur: unbiased wherever the dot lies among the pixels, since nothing is cut off by a threshold, and for
/// any shape (of tilted dots it is the centroid of the image, not the image of the centre; PinholeModel knows). The
/// background is the mean of a ring about the window that no dot reaches. With N electrons in a dot of diameter d shot
/// noise makes d / (4 sqrt(N)) px of it: 0.001 px for a dot of 6 px and a full well of 30,000 electrons.
/// @return in no order; empty where nothing stands out from the noise
std::vector<DetectedDot> detect_dots(Image<double> const& picture);

}  // namespace gladstone
