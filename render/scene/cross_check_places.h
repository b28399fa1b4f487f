#pragma once

#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Reports dots or a lens inside the medium.
void cross_check_geometry(Setup const& setup, SetupTable geometry);

/// Reports optical elements that overlap another object or violate the order of the light path along the camera's axis.
void cross_check_elements(Setup const& setup, SetupTable const& root);

}  // namespace gladstone::inline scene
