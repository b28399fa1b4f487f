#pragma once

#include "render/scene/field_map.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Returns a plan with the integration step of a scene and one ray per source: sufficient for maps of the field and for
/// given rays. With two media, the step is the shorter of both.
/// @throws DataError as with_step()
RenderPlan plan_step(Scene const& scene);

/// Completes a plan of plan_step() with the method and the number of rays, as plan_rendering() does.
/// @throws DataError as plan_rendering()
RenderPlan plan_rays(Scene const& scene, RenderPlan const& stepped);

/// Chooses integration step, method and number of rays of a scene where its setup leaves them open. For "auto" it
/// selects the fast renderer if that supports the scene (build_focused_dots()), with the number of rays and the
/// fineness by which its deflection table meets the accuracy goals, or comes closest. Otherwise the general renderer
/// adds rays until the goals or its budget are reached.
/// @param step  step of the same scene, if known; null: chosen
/// @throws DataError if the scene does not meet the conditions of its method
RenderPlan plan_rendering(Scene const& scene, IntegrationStep const* step = nullptr);

/// Estimates the processor time for rendering a scene by a plan with its (largest) number of rays: rays, deflection
/// table and small-angle theory [s].
double render_seconds(Scene const& scene, RenderPlan const& plan, RenderTheory theory);
/// Maps density, gradient and small-angle theory (Eq. 9) of the scene's field over the view.
FieldMap field_in_view(Scene const& scene, RenderPlan const& plan, int spacing_px);
/// Maps the strain of the displacement field over the view.
StrainMap strain_in_view(Scene const& scene, RenderPlan const& plan);

}  // namespace gladstone
