#pragma once

#include <string>
#include <vector>

#include "render/base/setup_table.h"

namespace gladstone {

/// One camera of a setup: a case of its own.
struct CameraCase {
  std::string name;  ///< of the camera and its folder; empty: the setup's only one, whose folder is the CASE itself
  SetupDocument document;  ///< with this camera alone
};

/// Names of the cameras of a setup that has several; empty where it has one.
std::vector<std::string> camera_names(SetupDocument const& setup);

/// Takes a setup apart: for each [[camera]] a setup with that camera alone, its own lens ([camera.lens]) or else the
/// setup's, the windows that it looks through, and noise of its own. All cameras of a BOS setup see one target: of the
/// size that their views take together, its middle at target.center_mm (default: the origin), its dots as many and as
/// large as the keys mean for the first camera.
/// @throws SetupError with the problems of all cameras: each needs a name, no two the same
std::vector<CameraCase> camera_cases(SetupDocument const& setup);

/// A setup of one camera as the readers take it: with the camera's lens and windows in their places. One of several
/// cameras stays as it is.
SetupDocument with_own_lens(SetupDocument setup);

}  // namespace gladstone
