#pragma once

#include <optional>
#include <string>

#include "render/base/warning.h"
#include "render/optics/lens.h"

namespace gladstone::inline optics {

/// Traces the axial beam and returns a warning if its light would run backwards through glass, because two faces of an
/// element cross within the beam. The warning names the second face; nullopt if no faces cross. Vignetted rays
/// are ignored.
/// @param object_distance  distance from the object to the first vertex [m]
std::optional<Warning> crossed_faces(Lens const& lens, double object_distance);

/// Returns the radius of the widest axial beam that is not vignetted by the edges of the surfaces, on the tangent plane
/// of the first vertex [m]; nullopt if the stop is the only limit.
/// @param object_distance  distance from the object to the first vertex [m]
std::optional<double> max_axial_beam_radius(Lens const& lens, double object_distance);

}  // namespace gladstone::inline optics
