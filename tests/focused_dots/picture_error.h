#pragma once

#include <algorithm>
#include <cmath>

#include "render/base/image.h"

namespace gladstone {

/// Error of an image over those pixels in which the correct image has at least one grey level.
struct PictureError {
  double rms_levels = 0;  ///< grey levels of 12 bits, with the brightest pixel of the correct image at 90 % of full
                          ///< scale
  int lit = 0;            ///< number of these pixels
};

inline PictureError picture_error(Image<double> const& found, Image<double> const& right) {
  double const level = *std::max_element(right.begin(), right.end()) / (0.9 * 4095);
  double square = 0;
  PictureError error;
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (right.data()[i] < level) continue;
    square += std::pow((found.data()[i] - right.data()[i]) / level, 2);
    ++error.lit;
  }
  error.rms_levels = std::sqrt(square / error.lit);
  return error;
}

}  // namespace gladstone
