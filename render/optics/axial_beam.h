#pragma once

#include <optional>
#include <string>

#include "render/optics/lens.h"

namespace gladstone {

/// Tells of an axial beam that would run backwards through glass: the faces of a piece cross within the beam, which no
/// lens can have. Rays that an edge takes on their way do not count.
/// @param object_distance from the first vertex [m] @return a warning that names the second face; empty: all is well
std::optional<std::string> crossed_faces(Lens const& lens, double object_distance);

/// How wide the edges of a lens let its axial beam be: the radius, on the tangent plane of the first vertex, of the
/// widest cone of rays that pass all surfaces [m]; empty: no edge takes any ray that the stop lets through.
/// @param object_distance from the first vertex [m]
std::optional<double> widest_beam(Lens const& lens, double object_distance);

}  // namespace gladstone
