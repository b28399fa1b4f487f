#pragma once

#include <string>

#include "render/base/image.h"
#include "render/scene/setup.h"

namespace gladstone {

/// Images of dots or particles, and the error that their places on the pixels cause.
struct SmallImages {
  double geometric_px = 0;  ///< diameter of the geometric image, g
  double spot_px = 0;       ///< e^-2 diameter of the diffraction spot
  double blur_px = 0;       ///< diameter of the disc of confusion

  /// e^-2 diameter of the whole image [px].
  double diameter_px() const;
  /// Error of a vector that whole-pixel locking causes, rms along the displacement (F26 without noise), by our
  /// correlator with 20 dots in a window [px].
  double locking_error_px() const;
  /// Factor on the f-number that widens the image to `diameter_px`: the spot grows, the disc of confusion shrinks. NaN
  /// where no factor above 1 does.
  double f_number_factor(double diameter_px) const;
};

/// Dots of a target, or the median particle in the middle of the sheet, by closed forms. @pre no calibration
SmallImages expected_images(Setup const& setup);

/// Distance that the lens is to be focused at, so that the images are `diameter_px` wide [m]: somewhat before dots or
/// sheet. NaN of a lens that is not an ideal thin one, and where images are as wide already.
double defocus_distance(Setup const& setup, double diameter_px);

/// Warns of images below least_image_px: their diameter, the error to be expected, and the f-number or the focus that
/// cures it. Empty where images are large enough. @pre no calibration
std::string locking_advice(Setup const& setup);

/// The same of a frame without a setup, by the autocorrelation of the dots in its middle (ImageStatistics); empty where
/// nothing is known of them. Their width over the pixels includes that of a pixel, 1/12 px^2 in variance, which is
/// taken off.
std::string locking_advice(Image<double> const& frame);

}  // namespace gladstone
