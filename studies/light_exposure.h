#pragma once

#include <optional>

#include "render/scene/setup.h"
#include "render/sensor/camera_equation.h"

namespace gladstone {

/// Reads [light], the light of white paper at the setup's wavelength, if it is there.
std::optional<PaperLight> read_light(SetupTable root);

/// Electrons in a fully lit pixel on the axis of a setup's camera under this light: what camera.exposure is to be.
double exposure_under(PaperLight const& light, Setup const& setup);

}  // namespace gladstone
