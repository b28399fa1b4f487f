#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_table.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {

/// Setup of one camera of a multi-camera setup, rendered as a separate case.
struct CameraCase {
  /// name of the camera and of its folder; empty if the setup has one camera, whose folder is the CASE itself
  std::string name;
  CaseSetup loaded;  ///< setup that contains this camera only
};

/// Returns the camera names of a setup with several cameras; empty for a setup with one camera.
std::vector<std::string> camera_names(SetupDocument const& setup);

/// Loads one setup per [[camera]], with the camera's lens ([camera.lens]) or else the setup's, the windows it looks
/// through, and an independent noise seed. All cameras of a BOS setup share one target: it covers the views of all
/// cameras and is centred at target.center_mm (default: the origin); number and size of its dots follow from the keys
/// evaluated for the first camera.
/// @throws SetupError with the problems of all cameras; each camera requires a unique name
std::vector<CameraCase> load_cameras(SetupDocument const& setup);

/// Checks names, types and ranges of the keys of a setup with any number of cameras, see check_setup_keys().
/// @throws SetupError with the problems of all cameras
void check_camera_keys(SetupDocument const& setup);

/// Returns a setup as written, with absolute file names.
/// @param cameras  all cameras of the setup
std::string written_setup(SetupDocument document, std::vector<CameraCase> const& cameras);

/// Returns a setup of one camera in the form that the readers expect, with the camera's lens and windows in [lens] and
/// [[window]]. A setup with several cameras is returned unchanged.
SetupDocument with_own_lens(SetupDocument setup);

}  // namespace gladstone::inline cases
