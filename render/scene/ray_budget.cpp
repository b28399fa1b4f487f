#include "render/scene/ray_budget.h"

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/scene/ray_hit.h"
#include "render/scene/scene.h"
#include "render/scene/spot.h"

namespace gladstone::inline scene {
namespace {

constexpr std::uint64_t most_rays = std::uint64_t{1} << 16, always_allowed = 1024;

}  // namespace

RenderPlan with_step(Scene const& scene, IntegrationStep const& step) {
  RenderPlan plan;
  plan.given_rays = scene.setup.render.rays_per_dot;
  plan.seed = scene.setup.render.seed;
  plan.polarity = scene.setup.target.polarity;
  plan.step_estimate = step;
  plan.step = step.step_mm * unit::millimetre;
  plan.pupil_margin = 1.25 * step.largest_shift;
  check_deflection_limit(plan.pupil_margin, scene.setup.z_b());
  return plan;
}

double ray_seconds(Scene const& scene, RenderPlan const& plan) {
  // Times [s]: emission, lens and sums; a step of the ray through the medium; a pixel of the PSF; a lens surface.
  constexpr double a_ray = 0.6e-6, a_step = 0.12e-6, a_pixel = 1.4e-9, a_surface = 60e-9;
  std::optional<AiryTable> airy;
  double const width = 2 * make_spot(scene, airy).half_width() + 1;
  double const surfaces =
      scene.setup.has_closed_form_layout() ? 0.0 : static_cast<double>(scene.camera.elements.size());
  return a_ray + a_step * scene.steps_across(plan.step) +
         frame_count * (a_pixel * width * width + a_surface * surfaces);
}

double rays_seconds(Scene const& scene, RenderPlan const& plan) {
  return static_cast<double>(scene.source_count()) * ray_seconds(scene, plan);
}

double theory_ray_seconds(Scene const& scene, RenderPlan const& plan) {
  constexpr double a_sample = 20e-9;  // time for one sample of the gradient [s]
  constexpr int samples_of_panel = 3;
  double const longest = std::min(plan.step, scene.medium.coarsest_step);
  double const panels = longest > 0 ? std::ceil(scene.steps_across(plan.step) * plan.step / longest) : 0;
  return samples_of_panel * panels * a_sample;
}

std::uint64_t max_rays_per_source(Scene const& scene, RenderPlan const& plan) {
  double const seconds = ray_seconds(scene, plan);
  std::uint64_t most = always_allowed;
  while (most < most_rays && 2 * static_cast<double>(most) * seconds <= source_budget_s) most *= 2;
  return most;
}

int error_bit_depth(CameraSetup const& camera) { return std::min(camera.bit_depth, 12); }

double light_per_level(CameraSetup const& camera, double exposure_e) {
  return camera.noise.full_well_e / exposure_e / (std::exp2(error_bit_depth(camera)) - 1);
}

}  // namespace gladstone::inline scene
