#pragma once

#include "render/scene/field_map.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Determines the integration step of a scene. With two media, the shorter of both steps.
IntegrationStep choose_step(Scene const& scene);
/// Returns the scene with the step of choose_step().
Scene with_chosen_step(Scene scene);
/// Determines the ray budget. For "auto" it selects the fast renderer if that supports the scene (focused_dots()), with
/// the number of rays and the fineness by which its deflection table meets the accuracy goals, or comes closest.
/// Otherwise the general renderer adds rays until the goals or its budget are reached.
/// @param scene  with its step
RayBudget choose_ray_budget(Scene const& scene);
/// Estimates the processor time for rendering a scene with its step and its (largest) number of rays: rays, deflection
/// table and small-angle theory [s].
double render_seconds(Scene const& scene, RenderTheory theory);
/// Maps density, gradient and small-angle theory (Eq. 9) of the scene's field over the view.
FieldMap field_in_view(Scene const& scene, int spacing_px);
/// Maps the strain of the displacement field over the view.
StrainMap strain_in_view(Scene const& scene);

}  // namespace gladstone
