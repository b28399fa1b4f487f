#include "render/scene/ray_budget.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/units.h"
#include "render/scene/ray_hit.h"
#include "render/scene/ray_scatter.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

constexpr double step_tolerance_px = 1e-4;
constexpr std::uint64_t most_rays = std::uint64_t{1} << 16, always_allowed = 1024;

}  // namespace

std::vector<double> changes(Probe const& coarse, Probe const& fine) {
  std::vector<double> change(coarse.displacement_px.size());
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] = length(coarse.displacement_px[i] - fine.displacement_px[i]);
  }
  return change;
}

std::vector<std::size_t> largest_of(std::vector<double> const& value) {
  std::vector<std::size_t> dots(value.size());
  std::iota(dots.begin(), dots.end(), std::size_t{0});
  if (dots.size() <= probed_dots) return dots;
  auto const more = [&value](std::size_t a, std::size_t b) {
    return value[a] > value[b] || (value[a] == value[b] && a < b);
  };
  std::partial_sort(dots.begin(), dots.begin() + probed_dots, dots.end(), more);
  dots.resize(probed_dots);
  return dots;
}

double Probe::largest_shift() const { return shift.empty() ? 0.0 : *std::max_element(shift.begin(), shift.end()); }

IntegrationStep choose_step(
    Scene const& scene,
    std::function<void(double step, std::function<void(StepProbes const&)> const&)> const& prepare) {
  // The step is stored in mm, so that a setup file contains exactly the number used.
  IntegrationStep plan;
  std::optional<double> const given = scene.setup.medium.step_mm;
  bool const empty = std::holds_alternative<NoMedium<double>>(scene.medium.view);
  double const coarsest = empty ? scene.setup.medium.thickness : scene.medium.coarsest_step;
  plan.step_mm = given.value_or(coarsest / unit::millimetre);
  if (!empty) {
    Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
    double const depth_mm = (box.high.z - box.low.z) / unit::millimetre;
    prepare(plan.step_mm * unit::millimetre, [&](StepProbes const& probes) {
      Probe coarse = probes.at(plan.step_mm * unit::millimetre);
      for (int halvings = 0;; ++halvings) {
        Probe fine = probes.at(plan.step_mm / 2 * unit::millimetre);
        plan.largest_shift = std::max({probes.largest_shift, coarse.largest_shift(), fine.largest_shift()});
        std::vector<double> const change = changes(coarse, fine);
        if (!change.empty()) {
          auto const most = std::max_element(change.begin(), change.end());
          plan.change_px = *most;
          plan.limiting_dot = probes.dots[static_cast<std::size_t>(most - change.begin())];
        }
        bool const finest = halvings == 12 || depth_mm > 0.5 * max_step_count * plan.step_mm;
        if (given || plan.change_px < step_tolerance_px || finest) break;
        plan.step_mm /= 2;
        coarse = std::move(fine);
      }
    });
  }
  return plan;
}

Scene with_step(Scene scene, IntegrationStep const& plan) {
  scene.step = plan.step_mm * unit::millimetre;
  scene.widen_pupil(1.25 * plan.largest_shift);
  return scene;
}

double ray_seconds(Scene const& scene) {
  // Times [s]: emission, lens and sums; a step of the ray through the medium; a pixel of the PSF; a lens surface.
  constexpr double a_ray = 0.6e-6, a_step = 0.12e-6, a_pixel = 1.4e-9, a_surface = 60e-9;
  std::optional<AiryTable> airy;
  double const width = 2 * make_spot(scene, airy).half_width() + 1;
  double const surfaces =
      scene.setup.has_closed_form_layout() ? 0.0 : static_cast<double>(scene.camera.elements.size());
  return a_ray + a_step * scene.steps_across() + frame_count * (a_pixel * width * width + a_surface * surfaces);
}

double rays_seconds(Scene const& scene) { return static_cast<double>(scene.source_count()) * ray_seconds(scene); }

double theory_ray_seconds(Scene const& scene) {
  constexpr double a_sample = 20e-9;  // a sample of the gradient [s]
  constexpr int samples_of_panel = 3;
  double const longest = std::min(scene.step, scene.medium.coarsest_step);
  double const panels = longest > 0 ? std::ceil(scene.steps_across() * scene.step / longest) : 0;
  return samples_of_panel * panels * a_sample;
}

std::uint64_t max_rays_per_source(Scene const& scene) {
  double const seconds = ray_seconds(scene);
  std::uint64_t most = always_allowed;
  while (most < most_rays && 2 * static_cast<double>(most) * seconds <= source_budget_s) most *= 2;
  return most;
}

std::optional<RayBudget> configured_ray_budget(Setup const& setup) {
  if (!setup.render.rays_per_dot) return std::nullopt;
  RayBudget plan;
  plan.rays = *setup.render.rays_per_dot;
  plan.bits = error_bit_depth(setup.camera);
  return plan;
}

Scene with_rays(Scene scene, RayBudget const& plan) {
  scene.rays_per_dot = plan.most > 0 ? plan.most : plan.rays;
  scene.adaptive_criteria = plan.adaptive_criteria;
  scene.rays_at_side_faces = plan.rays_at_side_faces;
  scene.fineness = plan.fineness;
  if (plan.method != RenderMethod::automatic) scene.setup.render.method = plan.method;
  return scene;
}

}  // namespace gladstone
