#pragma once

#include <string>

#include "render/base/warning.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Checks the setup across tables: focus, planes, steps across the medium, field of view, dot size, dot coverage.
/// Files are opened only to read the size of the field's grid. Problems are recorded at their keys in the setup's
/// document.
/// @return warnings
Warnings cross_check(Setup const& setup, SetupTable root);

/// Returns a hint if a length in mm was probably given in metres (below 2 mm); otherwise an empty text.
/// @param length  length [m]
std::string metres_hint(double length);

/// Warns of read noise that is clipped at zero.
void cross_check_noise(Setup const& setup, Warnings& warnings);

/// Reports diffraction PSFs that are too wide to resolve anything.
void cross_check_spot(Setup const& setup, SetupTable root);

/// Checks the camera's noise, the media between sources and camera, and the objects in them. Media of both pulses are
/// checked.
void cross_check_medium(Setup const& setup, SetupTable root, Warnings& warnings);

}  // namespace gladstone::inline scene
