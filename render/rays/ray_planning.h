#pragma once

#include "render/scene/ray_plan.h"

/// The plans of ray_plan.h for any scene, by ray tracing alone.
namespace gladstone {

/// Runs choose_step() with chief rays of all dots and with chief and edge rays of those that change most.
StepPlan plan_step_by_rays(Scene const& scene);

/// Measures the errors of all sources at the scene's current, non-adaptive number of rays. At most `most` rays per
/// source are traced; the errors of more are extrapolated as n^-1/2.
RaysPlan measure_rays_by_rays(Scene const& scene, std::uint64_t most = 4096);

/// Determines the criteria by which the ray number of each source is chosen: the light of a grey level at the camera's
/// bit depth, 12 bits at most. For "auto" exposure, the light of the brightest pixel is measured on a sample of
/// sources.
RaysByNeed need_of(Scene const& scene);

/// Plans the number of rays.
/// A number given in the setup applies to all sources. Otherwise the number is adaptive (ray_need.h): each source has
/// as many rays as it requires for 1e-3 px in its displacement and half a grey level in images, up to
/// most_rays_of_source(). Apart from the common exposure, it is independent of other sources. The remaining errors are
/// measured on a sample traced with other random numbers.
RaysPlan plan_rays_by_rays(Scene const& scene);
/// Like plan_rays_by_rays(scene), adaptive with known criteria.
RaysPlan plan_rays_by_rays(Scene const& scene, RaysByNeed const& need);

}  // namespace gladstone
