#pragma once

#include "render/scene/field_map.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Determines the integration step of a scene. With two media, the shorter of both steps.
IntegrationStep choose_step(Scene const& scene);
/// Returns a copy of the scene with the integration step of choose_step().
Scene with_chosen_step(Scene scene);
/// Determines the ray budget. For "auto" it selects the fast renderer if that supports the scene (focused_dots()), with
/// the number of rays and the node spacing of the deflection table that meet the accuracy goals, or come closest to
/// them. Otherwise the general renderer adds rays until it meets the goals or reaches its budget.
/// @param scene  scene whose integration step is set
RayBudget choose_ray_budget(Scene const& scene);
/// Estimates the processor time [s] for rendering a scene whose step and (largest) number of rays are set: for rays,
/// deflection table and small-angle theory.
double render_seconds(Scene const& scene, RenderTheory theory);
/// Computes maps of density, gradient and small-angle theory (Eq. 9) of the scene's field over the field of view.
FieldMap field_in_view(Scene const& scene, int spacing_px);
/// Computes a map of the strain of the displacement field over the field of view.
StrainMap strain_in_view(Scene const& scene);

}  // namespace gladstone
