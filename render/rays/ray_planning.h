#pragma once

#include "render/scene/ray_budget.h"

/// The plans of ray_budget.h for any scene, by ray tracing alone.
namespace gladstone {

/// Runs choose_step() with chief rays of all dots and with chief and edge rays of those that change most.
IntegrationStep determine_step_by_tracing(Scene const& scene);

/// Measures the errors of all sources at the scene's current, non-adaptive number of rays. At most `most` rays per
/// source are traced; the errors of more are extrapolated as n^-1/2.
RayBudget measure_errors_by_tracing(Scene const& scene, std::uint64_t most = 4096);

/// Determines the criteria by which the ray number of each source is chosen: the light of a grey level at the camera's
/// bit depth, 12 bits at most. For "auto" exposure, the light of the brightest pixel is measured on a sample of
/// sources.
AdaptiveRayCriteria determine_adaptive_criteria(Scene const& scene);

/// Plans the number of rays.
/// A number given in the setup applies to all sources. Otherwise the number is adaptive (ray_requirement.h): each
/// source has as many rays as it requires for 1e-3 px in its displacement and half a grey level in images, up to
/// max_rays_per_source(). Apart from the common exposure, it is independent of other sources. The remaining errors are
/// measured on a sample traced with other random numbers.
RayBudget determine_ray_budget_by_tracing(Scene const& scene);
/// Like determine_ray_budget_by_tracing(scene), adaptive with known criteria.
RayBudget determine_ray_budget_by_tracing(Scene const& scene, AdaptiveRayCriteria const& criteria);

}  // namespace gladstone
