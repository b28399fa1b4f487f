#pragma once

#include <cstddef>
#include <vector>

#include "render/scene/scene.h"

namespace gladstone {

/// Sources of which some rays cross a side face of the medium or pass it by, others do not: their displacement jumps
/// within the cone. Closed-form and periodic media have no side faces that a camera sees.
/// @return their numbers, rising
std::vector<std::size_t> sources_at_side_faces(Scene const& scene, DotPattern const& sources);

}  // namespace gladstone
