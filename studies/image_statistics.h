#pragma once

#include <cmath>

#include "render/base/image.h"

namespace gladstone {

/// What one picture of dots tells about itself; NaN where it does not.
struct ImageStatistics {
  double mean;             ///< [grey levels]
  double dot_diameter_px;  ///< e^-2 diameter of Gaussian dots of this picture's autocorrelation [px]
  double background;       ///< median of the flat part between the dots [grey levels]
  double dot_height;       ///< median height of the dots' peaks over the background (dark dots: below) [grey levels]
  double noise;            ///< standard deviation of a pixel's noise in the flat part; 0: none to be seen [grey levels]

  /// Height of the dots over the noise [1]; NaN where there is no noise, or no dot.
  double snr() const { return noise > 0 ? dot_height / noise : std::nan(""); }
};

/// Measures a picture of bright dots on dark, or dark dots on bright (told by the skewness).
///
/// Diameter: Gaussian dots of standard deviation d/4 have a Gaussian autocorrelation of variance d^2/8; it is taken at
/// shifts of 0, with the noise's share removed, and 1 px.
/// Noise: the response to the mask [1 -2 1; -2 4 -2; 1 -2 1], which sees neither levels nor slopes, has six times the
/// standard deviation of a pixel's white noise (Immerkaer, Comput. Vis. Image Underst. 64 (1996) 300). It is averaged
/// over the fifth of the places whose 3 x 3 mean is farthest from the dots': the mask is orthogonal to the mean, so
/// that this choice prefers no noise. Below black nothing is recorded: noise about a black level of 0 is seen by its
/// upper half. Dots: pixels that no neighbour exceeds and that rise over a third of the largest height. Pixels that are
/// nan or infinite are left out, with the neighbourhoods that hold one.
ImageStatistics image_statistics(Image<double> const& image);

}  // namespace gladstone
