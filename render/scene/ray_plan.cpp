#include "render/scene/ray_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/random.h"
#include "render/base/units.h"
#include "render/scene/dot_exposure.h"
#include "render/scene/trace_pair.h"

namespace gladstone {
namespace {

constexpr double step_tolerance_px = 1e-4;
constexpr double truth_tolerance_px = 1e-3;
constexpr double image_tolerance_levels = 0.5;
constexpr int scramblings = 4;
constexpr std::size_t sample_dots = 96;

/// Displacements of all dots by five shared rays each, and how far the lens plane sees them bent.
struct Probe {
  std::vector<Vec2d> displacement_px;
  double largest_bend = 0;
};

template <class Medium>
Probe probe_dots(Scene const& scene, Medium const& medium, double step) {
  SceneView<double> view = scene.view();
  view.tracing.step = step;
  view.train = {};  // bending matters here, not clipping
  view.train.append(ThinLens<double>{scene.setup.z_a, scene.setup.lens.focal_length});
  double const rim = scene.imaging.entrance_pupil / 2;
  Vec2d const pupil[5] = {{0, 0}, {rim, 0}, {0, rim}, {-rim, 0}, {0, -rim}};
  int const rays = scene.chief_rays_only() ? 1 : 5;
  Probe probe;
  probe.displacement_px.resize(scene.dots.centre.size());
  std::mutex merge;
  parallel_chunks(scene.dots.centre.size(), 64, [&](std::size_t begin, std::size_t end) {
    double bend = 0;
    for (std::size_t dot = begin; dot < end; ++dot) {
      throw_if_interrupted();
      Vec2d const centre = scene.dots.centre[dot];
      Vec2d sum{};
      int seen = 0;
      for (int ray = 0; ray < rays; ++ray) {
        Vec3d const start{centre.x, centre.y, view.sources.plane_z};
        Ray<double> const straight{
            start, normalized(Vec3d{pupil[ray].x - start.x, pupil[ray].y - start.y, view.bundle.lens_z - start.z})};
        RayHit<double> const flow = follow(view, medium, straight, 1.0);
        if (!reaches_sensor_plane(flow.status)) continue;
        RayHit<double> const reference = through_camera(view, straight, 1.0);
        sum += flow.pixel - reference.pixel;
        bend = std::max(bend, length(flow.at_lens - pupil[ray]));
        ++seen;
      }
      probe.displacement_px[dot] = seen > 0 ? sum / static_cast<double>(seen) : Vec2d{};
    }
    std::lock_guard const lock(merge);
    probe.largest_bend = std::max(probe.largest_bend, bend);
  });
  return probe;
}

Probe probe_at(Scene const& scene, double step) {
  return std::visit([&](auto const& medium) { return probe_dots(scene, medium, step); }, scene.medium.view);
}

/// Largest change between two probes, and where.
void measure_change(Probe const& coarse, Probe const& fine, StepPlan& plan) {
  plan.change_px = 0;
  for (std::size_t dot = 0; dot < coarse.displacement_px.size(); ++dot) {
    double const change = length(coarse.displacement_px[dot] - fine.displacement_px[dot]);
    if (change > plan.change_px) {
      plan.change_px = change;
      plan.limiting_dot = dot;
    }
  }
}

/// What one scrambling of one dot gives: its displacement, and its light in both frames over a window.
struct Sampled {
  Vec2d displacement;
  std::vector<double> light;
};

/// A window of one frame that collects a dot's light around a fixed pixel.
struct Window {
  int left, top, side;

  void collect(LightPatch const& patch, double scale, double* out) const {
    patch.for_each_touched([&](int column, int row, double weight) {
      int const i = column - left, j = row - top;
      if (i >= 0 && j >= 0 && i < side && j < side) out[j * side + i] += weight * scale;
    });
  }
};

template <class Medium>
Sampled sample_dot(Scene const& scene, SceneView<double> const& view, Medium const& medium, LightModel const& light,
                   std::size_t dot, Window const& window) {
  DotExposure exposure(light, true);
  LightImage* const nowhere[frame_count] = {};
  double const scale = scene.light_per_ray(scene.dots);
  TracePair<double, Medium> const pair{view, medium};
  exposure.begin(scene.dots.centre[dot], scene.dots.radiance_of(dot), nowhere, scale);
  trace_dot(pair, dot, scene.rays_per_dot, exposure);
  exposure.finish_light();
  Sampled sampled;
  auto const area = static_cast<std::size_t>(window.side * window.side);
  sampled.light.assign(2 * area, 0.0);
  window.collect(exposure.patch(Frame::reference), scale, sampled.light.data());
  window.collect(exposure.patch(Frame::flow), scale, sampled.light.data() + area);
  CentroidSum<double> const& reference = exposure.sum(Frame::reference);
  CentroidSum<double> const& flow = exposure.sum(Frame::flow);
  if (reference.weight > 0 && flow.weight > 0) sampled.displacement = flow.mean() - reference.mean();
  return sampled;
}

/// Scatter between scramblings at the scene's present number of rays.
struct Scatter {
  double truth_variance = 0;  ///< mean over dots and components [px^2]
  double light_variance = 0;  ///< mean over lit pixels
  double brightest = 0;
};

/// @param level light of one grey level where known, else 0: then 90 % of full scale is at the brightest pixel met
Scatter measure_scatter(Scene const& scene, std::vector<std::size_t> const& dots, SpotView const& spot, double level,
                        double levels_at_peak) {
  struct PerDot {
    double displacement_variance = 0;
    std::vector<double> mean, variance;
  };
  std::vector<PerDot> measured(dots.size());
  OwnedLightModel const light(scene, scene.dots, &spot);
  std::visit(
      [&](auto const& medium) {
        parallel_for(dots.size(), [&](std::size_t index) {
          std::size_t const dot = dots[index];
          int const side = 2 * spot.half_width() + 49;
          Vec2d const at = scene.to_pixel(scene.dots.centre[dot]);
          Window const window{static_cast<int>(std::floor(at.x)) - side / 2,
                              static_cast<int>(std::floor(at.y)) - side / 2, side};
          std::vector<Sampled> samples;
          for (int scrambling = 0; scrambling < scramblings; ++scrambling) {
            SceneView<double> view = scene.view();
            view.bundle.seed = repeat_seed(view.bundle.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
            samples.push_back(sample_dot(scene, view, medium, light.model, dot, window));
          }
          PerDot& result = measured[index];
          auto const unbiased = [&](auto const& value_of) {
            double mean = 0, square = 0;
            for (Sampled const& sample : samples) mean += value_of(sample) / scramblings;
            for (Sampled const& sample : samples) square += (value_of(sample) - mean) * (value_of(sample) - mean);
            return std::pair{mean, square / (scramblings - 1)};
          };
          result.displacement_variance = 0.5 * (unbiased([](Sampled const& s) { return s.displacement.x; }).second +
                                                unbiased([](Sampled const& s) { return s.displacement.y; }).second);
          for (std::size_t i = 0; i < samples[0].light.size(); ++i) {
            auto const [mean, variance] = unbiased([i](Sampled const& s) { return s.light[i]; });
            result.mean.push_back(mean);
            result.variance.push_back(variance);
          }
        });
      },
      scene.medium.view);

  Scatter scatter;
  for (PerDot const& dot : measured) {
    scatter.truth_variance += dot.displacement_variance / static_cast<double>(measured.size());
    scatter.brightest = std::max(scatter.brightest, *std::max_element(dot.mean.begin(), dot.mean.end()));
  }
  double const lit = level > 0 ? level : scatter.brightest / levels_at_peak;
  std::size_t lit_pixels = 0;
  for (PerDot const& dot : measured) {
    for (std::size_t i = 0; i < dot.mean.size(); ++i) {
      if (dot.mean[i] < lit) continue;
      scatter.light_variance += dot.variance[i];
      ++lit_pixels;
    }
  }
  if (lit_pixels > 0) scatter.light_variance /= static_cast<double>(lit_pixels);
  return scatter;
}

/// Dots spread evenly over the list (random dots are in random order, regular ones row by row), only those in view.
std::vector<std::size_t> choose_sample(Scene const& scene) {
  std::vector<std::size_t> in_view;
  for (std::size_t dot = 0; dot < scene.dots.centre.size(); ++dot) {
    if (scene.view().sensor.covers(scene.to_pixel(scene.dots.centre[dot]))) in_view.push_back(dot);
  }
  if (in_view.empty() && !scene.dots.centre.empty()) in_view.push_back(0);
  if (in_view.size() <= sample_dots) return in_view;
  std::vector<std::size_t> sample;
  for (std::size_t i = 0; i < sample_dots; ++i) sample.push_back(in_view[i * in_view.size() / sample_dots]);
  return sample;
}

}  // namespace

StepPlan plan_step(Scene& scene) {
  // the step is kept in mm, so that a setup file holds exactly the number used
  StepPlan plan;
  std::optional<double> const given = scene.setup.medium.step_mm;
  bool const empty = std::holds_alternative<NoMedium<double>>(scene.medium.view);
  double const coarsest = empty ? scene.setup.medium.thickness : scene.medium.coarsest_step;
  plan.step_mm = given.value_or(coarsest / unit::millimetre);
  if (!empty) {
    Probe coarse = probe_at(scene, plan.step_mm * unit::millimetre);
    for (int halvings = 0;; ++halvings) {
      Probe fine = probe_at(scene, plan.step_mm / 2 * unit::millimetre);
      plan.largest_bend = std::max(coarse.largest_bend, fine.largest_bend);
      measure_change(coarse, fine, plan);
      if (given || plan.change_px < step_tolerance_px || halvings == 12) break;
      plan.step_mm /= 2;
      coarse = std::move(fine);
    }
  }
  scene.step = plan.step_mm * unit::millimetre;
  scene.pupil_margin = 1.25 * plan.largest_bend;
  return plan;
}

RaysPlan plan_rays(Scene& scene) {
  RaysPlan plan;
  plan.bits = std::min(scene.setup.camera.bit_depth, 12);
  if (scene.setup.render.rays_per_dot) {
    scene.rays_per_dot = plan.rays = *scene.setup.render.rays_per_dot;
    return plan;
  }
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  std::vector<std::size_t> const sample = choose_sample(scene);
  CameraSetup const& camera = scene.setup.camera;
  double const full_scale = std::pow(2.0, plan.bits) - 1;
  // a given exposure fixes the light of a grey level; "auto" puts the brightest pixel at 90 % of full scale
  double const level = camera.exposure_e ? camera.noise.full_well_e / *camera.exposure_e / full_scale : 0.0;
  double const at_peak = 0.9 * full_scale;
  constexpr std::uint64_t most = std::uint64_t{1} << 16, most_measured = std::uint64_t{1} << 12;
  bool const single_ray = scene.chief_rays_only() && scene.dots.half_size == 0;
  Progress progress("choosing the rays", 8);
  double excess = 0, before = 0;  // errors over their tolerances, whichever is larger
  for (scene.rays_per_dot = single_ray ? 1 : 32;; scene.rays_per_dot *= 2) {
    Scatter const scatter = measure_scatter(scene, sample, spot, level, at_peak);
    double const light_per_level = level > 0 ? level : scatter.brightest / at_peak;
    plan.truth_error_px = std::sqrt(scatter.truth_variance);
    plan.image_error_levels = light_per_level > 0 ? std::sqrt(scatter.light_variance) / light_per_level : 0;
    before = excess;
    excess = std::max(plan.truth_error_px / truth_tolerance_px, plan.image_error_levels / image_tolerance_levels);
    plan.converged = excess <= 1;
    progress.advance();
    if (plan.converged || scene.rays_per_dot >= most_measured) break;
  }
  if (!plan.converged && before > 0) {
    // beyond what is measured, errors go on falling as they did last
    double const order = std::clamp(std::log2(before / excess), 0.5, 1.0);
    auto const measured = static_cast<double>(scene.rays_per_dot);
    while (scene.rays_per_dot < most && excess > 1) {
      scene.rays_per_dot *= 2;
      excess *= std::pow(2.0, -order);
    }
    double const gain = std::pow(static_cast<double>(scene.rays_per_dot) / measured, -order);
    plan.truth_error_px *= gain;
    plan.image_error_levels *= gain;
    plan.extrapolated = true;
    plan.converged = excess <= 1;
  }
  plan.rays = scene.rays_per_dot;
  return plan;
}

}  // namespace gladstone
