#pragma once

#include "render/base/warning.h"
#include "render/scene/scene.h"

namespace gladstone::inline scene {

/// Returns warnings for particles or flows that prevent a measurement.
Warnings warnings_of_particles(Scene const& scene);

}  // namespace gladstone::inline scene
