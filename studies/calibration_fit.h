#pragma once

#include "analysis/calibration/plate_placement.h"
#include "studies/calibrate.h"

namespace gladstone {

/// What the setup says of the camera that was calibrated, as far as it is known.
struct ExpectedCamera {
  std::optional<Vec2d> principal_point_px;  ///< nothing through windows, and where a tilt leaves it open
  std::optional<double> focal_length_px;    ///< of an ideal thin lens
  bool is_pinhole = true;                   ///< not so through windows
};

/// Fits both models to the dots of a calibration, and checks that they belong together:
/// - dots whose residual exceeds eight robust standard deviations are removed and counted;
/// - a middle dot that is off by one or two, and a plate that was not moved along its normal, show in residuals or in
/// the
///   principal point, and are corrected with a warning (PlatePlacement);
/// - pictures in another order, planes that show one and the same place, fits without a solution and residuals far
/// above
///   the scatter of the dots within their planes are errors that name the likely cause.
/// @param dots with the places that detection gave them @param name of the case or setup, for messages
/// @throws DataError
void fit_calibration(Calibration& calibration, PlateDots dots, ExpectedCamera const& expected, std::string const& name);

}  // namespace gladstone
