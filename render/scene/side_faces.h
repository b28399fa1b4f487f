#pragma once

#include <cstddef>
#include <vector>

#include "render/scene/render_plan.h"

namespace gladstone::inline scene {

/// Returns the indices of the sources whose light cone partly crosses and partly misses the medium at its side faces,
/// in ascending order. The displacement is discontinuous within such a cone.
/// Closed-form and periodic media have no side faces inside the view.
std::vector<std::size_t> sources_at_side_faces(Scene const& scene, RenderPlan const& plan, DotPattern const& sources);

}  // namespace gladstone::inline scene
