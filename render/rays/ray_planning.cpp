#include "render/rays/ray_planning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/units.h"
#include "render/rays/particle_tracer.h"
#include "render/rays/sample_images.h"
#include "render/scene/source_sample.h"
#include "render/scene/spot.h"
#include "render/scene/trace_ray.h"

namespace gladstone::inline rays {
namespace {

/// Rays from the centre of a source, as points of the unit disc that is mapped to its entrance pupil.
constexpr std::array chief_ray{Vec2d{0, 0}};
constexpr std::array cone{Vec2d{0, 0}, Vec2d{0.95, 0}, Vec2d{0, 0.95}, Vec2d{-0.95, 0}, Vec2d{0, -0.95}};

constexpr double step_tolerance_px = 1e-4;
/// Maximum number of dots that are probed with all rays. For larger targets, those that change most are chosen.
constexpr std::size_t probed_dots = 256;

/// Displacements of dots by a common set of rays, and their largest deflections on the lens plane.
struct Probe {
  std::vector<Vec2d> displacement_px;
  std::vector<double> shift;  ///< largest deflection of each dot's rays on the lens plane [m]

  double largest_shift() const { return shift.empty() ? 0.0 : *std::max_element(shift.begin(), shift.end()); }
};

/// Traces rays of some dots with given steps [m]. Quantities that do not depend on the step are computed once.
/// @return one probe per step
template <std::size_t Count>
std::array<Probe, Count> probe_dots(Scene const& scene, std::vector<std::size_t> const& dots,
                                    std::span<Vec2d const> rays, std::array<double, Count> const& steps) {
  std::array<Probe, Count> probes;
  for (Probe& probe : probes) {
    probe.displacement_px.resize(dots.size());
    probe.shift.resize(dots.size());
  }
  CameraView<double> const camera = scene.camera.view();
  TracingOptions<double> const options{steps[0], scene.setup.medium.ambient_refractivity(),
                                       scene.setup.medium.integrator, scene.setup.medium.faces};
  Progress progress("choosing the step", dots.size());
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(dots.size(), 16, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Vec3d const start = scene.source_place(dots[i]);
            auto const disc = scene.camera.apparent_pupil(start);
            std::array<Vec2d, Count> sum{};
            std::array<int, Count> seen{};
            for (std::size_t k = 0; disc && k < rays.size(); ++k) {
              throw_if_interrupted();
              Vec3d const aim = disc->centre + rays[k].x * disc->a + rays[k].y * disc->b;
              Ray<double> const ray{start, normalized(aim - start)};
              RayHit<double> const reference = trace_ray(camera, NoMedium<double>{}, options, ray, 1.0);
              for (std::size_t s = 0; s < Count; ++s) {
                TracingOptions<double> stepped = options;
                stepped.step = steps[s];
                RayHit<double> const flow = trace_ray(camera, medium, stepped, ray, 1.0);
                if (std::max(reference.status, flow.status) <= RayStatus::vignetted) {
                  probes[s].shift[i] = std::max(probes[s].shift[i], length(flow.at_lens - reference.at_lens));
                }
                if (!reaches_sensor_plane(reference.status) || !reaches_sensor_plane(flow.status)) continue;
                sum[s] += flow.pixel - reference.pixel;
                ++seen[s];
              }
            }
            for (std::size_t s = 0; s < Count; ++s) {
              probes[s].displacement_px[i] = seen[s] > 0 ? sum[s] / static_cast<double>(seen[s]) : Vec2d{};
            }
            progress.advance();
          }
        });
      },
      scene.medium.view);
  return probes;
}

/// Returns the difference of each dot's displacement between two probes [px].
std::vector<double> changes(Probe const& coarse, Probe const& fine) {
  std::vector<double> change(coarse.displacement_px.size());
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] = length(coarse.displacement_px[i] - fine.displacement_px[i]);
  }
  return change;
}

/// Returns the indices of the largest values, at most `probed_dots`.
std::vector<std::size_t> largest_of(std::vector<double> const& value) {
  std::vector<std::size_t> dots(value.size());
  std::iota(dots.begin(), dots.end(), std::size_t{0});
  auto const more = [&value](std::size_t a, std::size_t b) {
    return value[a] > value[b] || (value[a] == value[b] && a < b);
  };
  std::partial_sort(dots.begin(), dots.begin() + probed_dots, dots.end(), more);
  dots.resize(probed_dots);
  return dots;
}

}  // namespace

IntegrationStep determine_step_by_tracing(Scene const& scene) {
  // The step is stored in mm, so that a setup file contains exactly the number used.
  IntegrationStep step;
  std::optional<double> const given = scene.setup.medium.step_mm;
  bool const empty = std::holds_alternative<NoMedium<double>>(scene.medium.view);
  double const coarsest = empty ? scene.setup.medium.thickness : scene.medium.coarsest_step;
  step.step_mm = given.value_or(coarsest / unit::millimetre);
  if (empty) return step;
  // Select the dots whose chief rays change most.
  double shift_of_others = 0;
  std::vector<std::size_t> dots(scene.source_count());
  std::iota(dots.begin(), dots.end(), std::size_t{0});
  if (dots.size() > probed_dots) {
    double const length = step.step_mm * unit::millimetre;
    auto const [coarse, fine] = probe_dots(scene, dots, chief_ray, std::array{length, length / 2});
    shift_of_others = coarse.largest_shift();
    dots = largest_of(changes(coarse, fine));
  }
  // Halve the step until the displacements no longer change.
  std::span<Vec2d const> const rays = scene.chief_rays_only() ? std::span<Vec2d const>(chief_ray) : cone;
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  double const depth_mm = (box.high.z - box.low.z) / unit::millimetre;
  auto const metres = [](double step_mm) { return step_mm * unit::millimetre; };
  auto [coarse, fine] = probe_dots(scene, dots, rays, std::array{metres(step.step_mm), metres(step.step_mm / 2)});
  for (int halvings = 0;; ++halvings) {
    step.largest_shift = std::max({shift_of_others, coarse.largest_shift(), fine.largest_shift()});
    std::vector<double> const change = changes(coarse, fine);
    if (!change.empty()) {
      auto const most = std::max_element(change.begin(), change.end());
      step.change_px = *most;
      step.limiting_dot = dots[static_cast<std::size_t>(most - change.begin())];
    }
    bool const finest = halvings == 12 || depth_mm > 0.5 * max_step_count * step.step_mm;
    if (given || step.change_px < step_tolerance_px || finest) return step;
    step.step_mm /= 2;
    coarse = std::move(fine);
    fine = std::move(probe_dots(scene, dots, rays, std::array{metres(step.step_mm / 2)})[0]);
  }
}

AdaptiveRayCriteria determine_adaptive_criteria(Scene const& scene, RenderPlan const& plan) {
  CameraSetup const& camera = scene.setup.camera;
  double const full_scale = std::exp2(error_bit_depth(camera)) - 1;
  AdaptiveRayCriteria criteria;
  criteria.brightest_at = 0.9 * full_scale;
  if (camera.absolute_exposure || camera.exposure_e) {
    double const electrons =
        camera.absolute_exposure ? scene.photon_unit * camera.noise.quantum_efficiency : *camera.exposure_e;
    criteria.level = light_per_level(camera, electrons);
    return criteria;
  }
  RenderPlan metered = plan;
  metered.adaptive_criteria.reset();
  metered.rays = 64;  // accuracy of a few percent for the brightest pixel and thus for a grey level
  criteria.level = brightest_pixel(render_sample(scene, metered, all_sources(scene))) / criteria.brightest_at;
  return criteria;
}

RenderPlan plan_rays_by_tracing(Scene const& scene, RenderPlan plan) {
  if (plan.given_rays) {
    plan.rays = *plan.given_rays;
    return plan;
  }
  bool const one_path = scene.chief_rays_only() && scene.dots.half_size == 0;
  plan.rays = one_path ? 1 : max_rays_per_source(scene, plan);
  plan.adaptive_criteria = determine_adaptive_criteria(scene, plan);
  return plan;
}

std::uint64_t largest_ray_number(Scene const& scene, RenderPlan const& plan) {
  if (scene.setup.experiment().sources.on_target) return plan.rays;
  std::optional<AiryTable> airy;
  return static_cast<std::uint64_t>(
      ParticleLaunches(scene, plan, make_spot(scene, airy), RenderImages::yes).ladder.view().goal.most);
}

}  // namespace gladstone::inline rays
