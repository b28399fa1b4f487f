#pragma once

#include "render/base/warning.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Checks a PIV setup across keys: particles that scatter no light, a laser sheet outside the volume, optical elements,
/// wavelengths.
void cross_check_particles(Setup const& setup, SetupTable root, Warnings& warnings);

}  // namespace gladstone::inline scene
