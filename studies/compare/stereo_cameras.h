#pragma once

#include <string>

#include "analysis/stereo/stereo_camera.h"
#include "render/scene/setup.h"

namespace gladstone::inline compare {

/// Reads the pinhole camera of a calibration.h5 with its covariance. Warns if the polynomial fits the dots much better,
/// as it does for cameras that look through windows.
/// @throws DataError if the file is not one of gladstone calibrate, or does not determine the camera
stereo::CalibratedCamera read_calibrated_camera(std::string const& path);

/// Returns the exact camera of a setup.
/// @param name  name of the case, for messages
/// @throws DataError if the setup's camera is not a pinhole camera (see equivalent_pinhole())
stereo::CalibratedCamera find_exact_camera(Setup const& setup, std::string const& name);

}  // namespace gladstone::inline compare
