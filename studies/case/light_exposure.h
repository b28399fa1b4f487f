#pragma once

#include <optional>

#include "render/scene/setup.h"
#include "render/sensor/camera_equation.h"

namespace gladstone::inline cases {

/// Reads the optional table [light]: illumination of white paper at the setup's wavelength.
std::optional<PaperLight> read_light(SetupTable root);

/// Returns the value of camera.exposure under this light: electrons in a fully lit pixel on the axis [e].
double exposure_from_light(PaperLight const& light, Setup const& setup);

}  // namespace gladstone::inline cases
