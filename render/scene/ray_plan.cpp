#include "render/scene/ray_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/progress.h"
#include "render/base/units.h"
#include "render/scene/ray_hit.h"
#include "render/scene/ray_scatter.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

constexpr double step_tolerance_px = 1e-4;
constexpr std::uint64_t most_rays = std::uint64_t{1} << 16, most_measured = std::uint64_t{1} << 12;
constexpr std::uint64_t always_allowed = 1024;

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

double Probe::largest_bend() const { return bend.empty() ? 0.0 : *std::max_element(bend.begin(), bend.end()); }

StepPlan choose_step(Scene const& scene,
                     std::function<void(double step, std::function<void(StepProbes const&)> const&)> const& prepare) {
  // the step is kept in mm, so that a setup file holds exactly the number used
  StepPlan plan;
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
        plan.largest_bend = std::max({probes.largest_bend, coarse.largest_bend(), fine.largest_bend()});
        std::vector<double> const change = changes(coarse, fine);
        if (!change.empty()) {
          auto const most = std::max_element(change.begin(), change.end());
          plan.change_px = *most;
          plan.limiting_dot = probes.dots[static_cast<std::size_t>(most - change.begin())];
        }
        bool const finest = halvings == 12 || depth_mm > 0.5 * most_steps * plan.step_mm;
        if (given || plan.change_px < step_tolerance_px || finest) break;
        plan.step_mm /= 2;
        coarse = std::move(fine);
      }
    });
  }
  return plan;
}

void use_step(Scene& scene, StepPlan const& plan) {
  scene.step = plan.step_mm * unit::millimetre;
  scene.widen_pupil(1.25 * plan.largest_bend);
}

double rays_seconds(Scene const& scene) {
  // emission, lens and sums; a step of the flow ray; a pixel that a spot is spread over [s]
  constexpr double a_ray = 0.6e-6, a_step = 0.12e-6, a_pixel = 1.4e-9;
  std::optional<AiryTable> airy;
  double const width = 2 * make_spot(scene, airy).half_width() + 1;
  double const ray = a_ray + a_step * scene.steps_across() + frame_count * a_pixel * width * width;
  return static_cast<double>(scene.source_count()) * ray;
}

std::optional<RaysPlan> given_rays(Setup const& setup) {
  if (!setup.render.rays_per_dot) return std::nullopt;
  RaysPlan plan;
  plan.rays = *setup.render.rays_per_dot;
  plan.bits = plan_bits(setup.camera);
  return plan;
}

RaysPlan choose_rays(Scene& scene, std::function<RaysPlan()> const& measure, double seconds_a_ray) {
  RaysPlan plan;
  std::uint64_t most = always_allowed;
  while (most < most_rays && 2 * static_cast<double>(most) * seconds_a_ray <= rays_budget_s) most *= 2;
  bool const single_ray = scene.chief_rays_only() && scene.dots.half_size == 0;
  Progress progress("choosing the rays", 8);
  std::vector<double> excess;  // errors over their tolerances, whichever is larger, from doubling to doubling
  for (scene.rays_per_dot = single_ray ? 1 : 32;; scene.rays_per_dot *= 2) {
    plan = measure();
    excess.push_back(plan.excess());
    plan.converged = excess.back() <= 1;
    progress.advance();
    if (plan.converged || scene.rays_per_dot >= std::min(most, most_measured)) break;
  }
  plan.rays_wanted = static_cast<double>(scene.rays_per_dot);
  if (!plan.converged) {
    // beyond what is measured, errors go on falling as they did over the last three doublings
    double const order = std::clamp(std::log2(excess[excess.size() - 4] / excess.back()) / 3, 0.5, 1.0);
    double const measured = plan.rays_wanted;
    plan.rays_wanted *= std::exp2(std::ceil(std::log2(excess.back()) / order));
    plan.converged = plan.rays_wanted <= static_cast<double>(most);
    scene.rays_per_dot = plan.converged ? static_cast<std::uint64_t>(plan.rays_wanted) : most;
    double const gain = std::pow(static_cast<double>(scene.rays_per_dot) / measured, -order);
    plan.truth_error_px *= gain;
    plan.image_error_levels *= gain;
    plan.extrapolated = scene.rays_per_dot > static_cast<std::uint64_t>(measured);
  }
  plan.rays = scene.rays_per_dot;
  plan.seconds = seconds_a_ray * static_cast<double>(plan.rays);
  return plan;
}

}  // namespace gladstone
