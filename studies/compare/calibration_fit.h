#pragma once

#include "analysis/calibration/plate_placement.h"
#include "studies/compare/calibrate.h"

namespace gladstone::inline compare {

/// Expected properties of the calibrated camera, as far as the setup determines them.
struct ExpectedCamera {
  /// expected principal point; empty through windows, or if the sensor is tilted and no pinhole model exists [px]
  std::optional<Vec2d> principal_point_px;
  std::optional<double> focal_length_px;  ///< expected focal length; empty unless the lens is an ideal thin lens [px]
  bool is_pinhole = true;                 ///< false if the camera looks through windows
};

/// Fits a pinhole camera and a polynomial to the dots of a calibration and checks their consistency.
/// - Dots whose residual exceeds eight robust standard deviations are removed and counted.
/// - Middle dots assigned wrongly by whole spacings, or a plate not moved along its normal, show in the residuals or
///   the principal point and are corrected with a warning (PlatePlacement).
/// - Unequal fx and fy together with a plate not moved along its normal are an error if any middle dot is a guess.
/// - Images in the wrong order, two planes at the same position, fits without a solution, and residuals far above the
///   scatter of the dots within their planes are errors; the message names the likely cause.
/// @param dots      detected dots with their grid indices
/// @param expected  camera according to the setup
/// @param name      name of the case or setup, for messages
/// @throws DataError if the dots do not determine a camera
void fit_calibration(Calibration& calibration, PlateDots dots, ExpectedCamera const& expected, std::string const& name);

}  // namespace gladstone::inline compare
