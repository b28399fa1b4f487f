#pragma once

#include <cmath>

#include "render/base/image.h"

namespace gladstone::inline cases {

/// Statistics of one image of dots, estimated from the image itself; NaN: cannot be estimated.
struct ImageStatistics {
  double mean;             ///< [grey levels]
  double dot_diameter_px;  ///< e^-2 diameter of Gaussian dots with the image's autocorrelation [px]
  double background;       ///< median of the flat part between the dots [grey levels]
  double dot_height;       ///< median peak height of the dots above the background (dark dots: below it) [grey levels]
  double noise;            ///< standard deviation of a pixel's noise in the flat part; 0: no noise found [grey levels]

  /// Returns the signal-to-noise ratio, dot height over noise [1]; NaN without noise or dots.
  double snr() const { return noise > 0 ? dot_height / noise : std::nan(""); }
};

/// Measures an image of bright dots on dark, or of dark dots on bright, distinguished by the skewness.
/// - Diameter: Gaussian dots of standard deviation d/4 have a Gaussian autocorrelation of variance d^2/8, evaluated at
///   shifts of 0, after subtracting the noise variance, and 1 px.
/// - Noise: the response to the mask [1 -2 1; -2 4 -2; 1 -2 1], which suppresses levels and slopes, has six times the
///   standard deviation of a pixel's white noise (Immerkaer, Comput. Vis. Image Underst. 64 (1996) 300). It is averaged
///   over the 20 % of the 3 x 3 neighbourhoods whose mean is farthest from the dots' level; the mask is orthogonal to
///   the mean, so this selection causes no bias. At a black level of 0, only the upper half of the noise is recorded
///   and used.
/// - Dots: local maxima that exceed a third of the largest height. Neighbourhoods with a pixel that is NaN or infinite
///   are skipped.
ImageStatistics image_statistics(Image<double> const& image);
/// Measures ImageStatistics::dot_diameter_px only.
double measure_dot_diameter_px(Image<double> const& image);

}  // namespace gladstone::inline cases
