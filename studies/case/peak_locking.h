#pragma once

#include <string>

#include "render/base/image.h"
#include "render/base/warning.h"
#include "render/scene/setup.h"

namespace gladstone::inline cases {

/// Image diameters of dots or particles, and the peak-locking error that they cause.
struct ImageDiameters {
  double geometric_px = 0;  ///< diameter of the geometric image [px]
  double spot_px = 0;       ///< e^-2 diameter of the diffraction-limited PSF [px]
  double blur_px = 0;       ///< diameter of the circle of confusion [px]
  double distance = 0;      ///< distance from the lens to dots or particle, along the camera's axis [m]

  /// Returns the e^-2 diameter of the total image [px].
  double diameter_px() const;
  /// Returns the rms error of a vector component along the displacement from peak locking, without noise (F26 in
  /// docs/design.md), for our correlator with 20 dots per window [px].
  double locking_error_px() const;
  /// Returns the factor on the f-number that widens the image to `diameter_px`: the PSF grows, the circle of confusion
  /// shrinks. NaN if no factor above 1 does.
  double f_number_factor(double diameter_px) const;
};

/// Returns the expected images of the target's dots, or of the median particle in the middle of the sheet, from closed
/// forms.
/// @pre not a calibration
ImageDiameters expected_images(Setup const& setup);

/// Returns the focus distance, somewhat in front of dots or sheet, at which the images have the width `diameter_px`
/// [m]. NaN unless the lens is an ideal thin lens, or if the images are already that wide.
double defocus_distance(Setup const& setup, double diameter_px);

/// Returns a warning of images more than 0.5 % below min_image_px, with their diameter, the expected error, and the
/// f-number or focus distance that avoids it; nullopt if the images are large enough.
/// @pre not a calibration
std::optional<Warning> locking_advice(Setup const& setup);

/// Returns the same warning for a frame without a setup, from the autocorrelation of the dots in its middle
/// (ImageStatistics); nullopt if their size cannot be estimated. The measured width includes the pixel's own variance
/// of 1/12 px^2, which is subtracted.
std::optional<Warning> locking_advice(Image<double> const& frame);

}  // namespace gladstone::inline cases
