#pragma once

#include "render/scene/ray_plan.h"

/// The plans of ray_plan.h for any scene, by trace_ray alone.
namespace gladstone {

/// choose_step() by chief rays of all dots, and chief and rim rays of those that change most. Sets step and margin.
StepPlan plan_step_by_rays(Scene& scene);

/// Errors at the scene's number of rays, measured with up to 4096, of which more scatter no more than by chance.
RaysPlan measure_rays_by_rays(Scene const& scene);

/// choose_rays() by the light that every ray lays down, and the scatter of centroids.
RaysPlan plan_rays_by_rays(Scene& scene);

}  // namespace gladstone
