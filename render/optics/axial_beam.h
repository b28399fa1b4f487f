#pragma once

#include <optional>

#include "render/optics/lens.h"

namespace gladstone {

/// Refuses a lens whose axial beam would run backwards through glass: the faces of a piece cross within the beam, which
/// no lens can have. Rays that an edge takes on their way do not count.
/// @param object_distance from the first vertex [m] @throws DataError naming the second face
void refuse_crossed_faces(Lens const& lens, double object_distance);

/// How wide the edges of a lens let its axial beam be: the height at the stop of the widest cone of rays that pass all
/// surfaces [m]; empty: no edge takes any ray that the stop lets through.
/// @param object_distance from the first vertex [m]
std::optional<double> widest_at_stop(Lens const& lens, double object_distance);

}  // namespace gladstone
