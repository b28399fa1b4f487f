#pragma once

#include "render/scene/field_map.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Determines the integration step of a scene. With two media, the shorter of both steps.
IntegrationStep choose_step(Scene const& scene);
/// Returns the scene with the step of choose_step().
Scene with_chosen_step(Scene scene);
/// Determines the ray budget and, for "auto", the method. It selects the fast renderer if the interpolation error of
/// its deflection table is within the accuracy goals of "auto", or smaller than the scatter of the general renderer's
/// rays; but the general renderer if the table takes more than 5 s and 60 times the processor time of the rays, and
/// their number is given or sufficient.
/// @param scene  with its step
RayBudget choose_ray_budget(Scene const& scene);
/// Estimates the processor time for rendering a planned scene: rays, deflection table and small-angle theory [s].
double render_seconds(Scene const& scene, RayBudget const& plan, RenderTheory theory);
/// Maps density, gradient and small-angle theory (Eq. 9) of the scene's field over the view.
FieldMap field_in_view(Scene const& scene, int spacing_px);
/// Maps the strain of the displacement field over the view.
StrainMap strain_in_view(Scene const& scene);

}  // namespace gladstone
