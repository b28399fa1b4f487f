#pragma once

#include "render/scene/ray_plan.h"

/// The plans of ray_plan.h for any scene, by trace_ray alone.
namespace gladstone {

/// choose_step() by chief rays of all dots, and chief and rim rays of those that change most. Sets step and margin.
StepPlan plan_step_by_rays(Scene& scene);

/// Errors at the scene's present number of rays, of all sources alike, measured with up to `most`, of which more
/// scatter no more than by chance.
RaysPlan measure_rays_by_rays(Scene const& scene, std::uint64_t most = 4096);

/// What every source's number of rays is chosen by: the light of a grey level, at the bit depth or at 12 bits if that
/// is coarser. Where "auto" is to expose the camera, a sample of sources tells the light of the brightest pixel.
RaysByNeed need_of(Scene const& scene);

/// Keeps a given number of rays for all sources. Otherwise every source takes what it needs (ray_need.h) for 1e-3 px in
/// its displacement and half a grey level in images, as far as most_rays_of_source(); it hangs on no other source,
/// but for the exposure that all share. A sample of them, traced with other random numbers, tells the errors that this
/// leaves. Sets the scene's rays.
RaysPlan plan_rays_by_rays(Scene& scene);
/// The same for what is known of the exposure.
RaysPlan plan_rays_by_rays(Scene& scene, RaysByNeed const& need);

}  // namespace gladstone
