#pragma once

#include "render/focused_dots/focused_dots.h"
#include "render/scene/render_plan.h"

namespace gladstone {

/// Returns the method that renders a scene: that of the plan, otherwise that of the setup. Resolves `automatic` to
/// rays, focused_dots or formula.
RenderMethod resolve_render_method(Scene const& scene, RenderPlan const& plan = {});

/// Returns the name of the method in files: "focused_dots", "formula" or "rays" (also for `automatic`).
char const* to_string(RenderMethod method);

/// Returns the scene as the fast renderer requires it.
/// @throws DataError if the scene does not meet the conditions of "focused_dots"
FocusedDots require_focused_dots(Scene const& scene, RenderPlan const& plan = {});

}  // namespace gladstone
