#pragma once

#include <cstdint>

#include "render/scene/render_plan.h"

namespace gladstone::inline scene {

/// Maximum processor time for the rays of one source with an adaptive ray number [s]: one minute for the 5000 dots of
/// 512 x 512 px. The limit applies per source, so that the ray number of a source does not depend on the others. The
/// resulting maximum is between 1024 and 65,536 rays.
inline constexpr double source_budget_s = 0.012;

/// Returns the bit depth in which image errors are stated: the camera's, 12 at most.
int error_bit_depth(CameraSetup const& camera);
/// Returns the light of one grey level at error_bit_depth().
/// @param exposure_e  electrons per unit of light
double light_per_level(CameraSetup const& camera, double exposure_e);

/// Estimates the processor time per ray of one source, traced in both images [s].
/// Integration steps, lit pixels and lens surfaces are counted and multiplied by times measured on the processor of
/// docs/benchmarks.md. No clock is read, so the estimate, and hence the ray number, is the same on any machine.
double ray_seconds(Scene const& scene, RenderPlan const& plan);
/// Estimates the processor time for one ray of every source [s].
double rays_seconds(Scene const& scene, RenderPlan const& plan);

/// Estimates the processor time of small-angle theory (Eq. 9) along one straight ray through the medium [s].
double theory_ray_seconds(Scene const& scene, RenderPlan const& plan);

/// Returns the maximum number of rays per source for adaptive ray numbers: a power of two from 1024 to 65,536.
std::uint64_t max_rays_per_source(Scene const& scene, RenderPlan const& plan);

/// Returns a plan with an integration step and the margin of the pupil that its deflections require, with the seed, the
/// polarity and the given number of rays of the scene's setup, and with one ray per source.
/// @throws DataError if rays are deflected by more than 45 degrees before they reach the lens: no real set-up does so,
/// and the search for a sufficient margin would not terminate
RenderPlan with_step(Scene const& scene, IntegrationStep const& step);

}  // namespace gladstone::inline scene
