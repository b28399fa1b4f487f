#pragma once

#include "render/scene/ray_budget.h"

/// Integration step and number of rays of any scene.
namespace gladstone::inline rays {

/// Chooses the integration step such that halving it changes no dot's displacement by more than 1e-4 px.
/// The search starts at medium.coarsest_step and halves it up to 12 times. A step given in the setup is used unchanged,
/// and its error is measured. Chief rays of all dots are traced, and chief and edge rays of those that change most.
IntegrationStep determine_step_by_tracing(Scene const& scene);

/// Determines the criteria by which the ray number of each source is chosen: the light of a grey level at the camera's
/// bit depth, 12 bits at most. For "auto" exposure, the light of the brightest pixel is measured on a sample of
/// sources.
AdaptiveRayCriteria determine_adaptive_criteria(Scene const& scene, RenderPlan const& plan);

/// Completes a plan that has a step with the number of rays of the general renderer.
/// A number given in the setup applies to all sources. Otherwise the number is adaptive (ray_requirement.h): each
/// source takes as many rays as its displacement requires for 1e-3 px and its images for half a grey level, up to
/// max_rays_per_source(). Apart from the common exposure, it is independent of other sources.
RenderPlan plan_rays_by_tracing(Scene const& scene, RenderPlan plan);

/// Returns the largest number of rays that a source of the general renderer can take: RenderPlan::rays, or the nodes
/// of the finest cubature rule of particles.
std::uint64_t largest_ray_number(Scene const& scene, RenderPlan const& plan);

}  // namespace gladstone::inline rays
