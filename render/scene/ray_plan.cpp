#include "render/scene/ray_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/random.h"
#include "render/base/units.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_exposure.h"
#include "render/focused_dots/light_model.h"
#include "render/focused_dots/trace_pair.h"
#include "render/scene/ray_scatter.h"

namespace gladstone {
namespace {

constexpr double step_tolerance_px = 1e-4;
constexpr std::uint64_t most_rays = std::uint64_t{1} << 16, most_measured = std::uint64_t{1} << 12;
constexpr std::uint64_t always_allowed = 1024;
constexpr int scramblings = plan_scramblings;
constexpr double widest_image_px = 100;  // of a dot that is measured whole

constexpr std::size_t checked_dots = 24;  // of these, whose table is checked by rays alone
constexpr std::uint64_t fewest_checking_rays = 1024, most_checking_rays = 16384;

/// A ray that a dot is probed by.
struct ProbeRay {
  Vec2d beside;  ///< where it starts, from the dot's centre [m]
  Vec2d pupil;   ///< where it runs to [m]
};

template <class Medium>
Probe probe_dots(Scene const& scene, Medium const& medium, std::vector<std::size_t> const& dots,
                 std::vector<ProbeRay> const& rays, double step) {
  SceneView<double> view = scene.view();
  view.tracing.step = step;
  view.train = {};  // bending matters here, not clipping
  view.train.append(ThinLens<double>{scene.setup.z_a, scene.setup.lens.focal_length});
  Probe probe;
  probe.displacement_px.resize(dots.size());
  probe.bend.resize(dots.size());
  parallel_chunks(dots.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec2d const centre = scene.dots.centre[dots[i]];
      Vec2d sum{};
      int seen = 0;
      for (auto const& [beside, pupil] : rays) {
        throw_if_interrupted();
        Vec3d const start{centre.x + beside.x, centre.y + beside.y, view.sources.plane_z};
        Ray<double> const straight{
            start, normalized(Vec3d{pupil.x - start.x, pupil.y - start.y, view.bundle.lens_z - start.z})};
        RayHit<double> const flow = follow(view, medium, straight, 1.0);
        if (!reaches_sensor_plane(flow.status)) continue;
        RayHit<double> const reference = through_camera(view, straight, 1.0);
        sum += flow.pixel - reference.pixel;
        probe.bend[i] = std::max(probe.bend[i], length(flow.at_lens - pupil));
        ++seen;
      }
      probe.displacement_px[i] = seen > 0 ? sum / static_cast<double>(seen) : Vec2d{};
    }
  });
  return probe;
}

/// Probes the dots of a scene at one step after the other.
class StepProbe {
 public:
  /// Chooses the dots to be probed: those whose chief rays change most when this step is halved. About those whose
  /// chief rays are bent most the bend is looked for on a lattice that fills the gaps to their neighbours, which may be
  /// wider than what bends rays most.
  StepProbe(Scene const& scene, double step) : scene_(scene), dots_(scene.dots.centre.size()), cone_{{}} {
    double const rim = scene.imaging.entrance_pupil / 2;
    if (!scene.chief_rays_only()) cone_ = {{}, {{}, {rim, 0}}, {{}, {0, rim}}, {{}, {-rim, 0}}, {{}, {0, -rim}}};
    std::iota(dots_.begin(), dots_.end(), std::size_t{0});
    if (dots_.size() <= probed_dots) return;
    Probe const coarse = probe(dots_, {{}}, step), fine = probe(dots_, {{}}, step / 2);
    largest_bend_ = probe(largest_of(coarse.bend), about_dot(), step).largest_bend();
    dots_ = largest_of(changes(coarse, fine));
  }

  StepProbes probes() const {
    return {dots_, largest_bend_, [this](double step) { return probe(dots_, cone_, step); }};
  }

 private:
  Probe probe(std::vector<std::size_t> const& dots, std::vector<ProbeRay> const& rays, double step) const {
    return std::visit([&](auto const& medium) { return probe_dots(scene_, medium, dots, rays, step); },
                      scene_.medium.view);
  }
  /// Chief rays from a lattice about a dot, as wide as dots are apart on average.
  std::vector<ProbeRay> about_dot() const {
    constexpr int side = 5;
    Vec2d low = scene_.dots.centre[0], high = low;
    for (Vec2d const c : scene_.dots.centre) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
    double const spacing = std::sqrt((high.x - low.x) * (high.y - low.y) / static_cast<double>(dots_.size()));
    std::vector<ProbeRay> rays;
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        rays.push_back({spacing / side * Vec2d{column - 0.5 * (side - 1), row - 0.5 * (side - 1)}, {}});
      }
    }
    return rays;
  }

  Scene const& scene_;
  std::vector<std::size_t> dots_;
  std::vector<ProbeRay> cone_;  ///< by which these are probed
  double largest_bend_ = 0;
};

template <class Medium>
Sampled sample_dot(Scene const& scene, SceneView<double> view, Medium const& medium, LightModel model, std::size_t dot,
                   Window const& window) {
  // pixels are counted from the window's corner: the sensor's own first pixel moves, its axis does not
  view.sensor.columns -= 2 * window.left;
  view.sensor.rows -= 2 * window.top;
  model.image.axis_px = model.image.axis_px - Vec2d{static_cast<double>(window.left), static_cast<double>(window.top)};
  LightImage frames[frame_count] = {{window.side, window.side}, {window.side, window.side}};
  LightImage* const images[frame_count] = {&frames[0], &frames[1]};
  DotExposure exposure(model, true);
  TracePair<double, Medium> const pair{view, medium};
  exposure.begin(scene.dots.centre[dot], scene.dots.radiance_of(dot), images, scene.light_per_ray(scene.dots));
  trace_dot(pair, dot, scene.rays_per_dot, exposure);
  GroundTruth truth;
  truth.resize(1);
  exposure.finish(truth, 0);
  Sampled sampled;
  if (std::isfinite(truth.displacement_px[0].x)) sampled.displacement = truth.displacement_px[0];
  for (LightImage const& frame : frames) {
    Image<double> const light = frame.to_light();
    sampled.light.insert(sampled.light.end(), light.begin(), light.end());
  }
  return sampled;
}

/// The scene's view with other rays.
SceneView<double> scrambled(Scene const& scene, int scrambling) {
  SceneView<double> view = scene.view();
  view.bundle.seed = repeat_seed(view.bundle.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
  return view;
}

template <class Medium>
MeanDisplacement mean_displacement(Scene const& scene, Medium const& medium, LightModel const& model, std::size_t index,
                                   std::uint64_t rays) {
  Vec2d found[scramblings];
  DotExposure exposure(model, false);
  LightImage* const no_images[frame_count] = {};
  GroundTruth truth;
  truth.resize(1);
  for (int scrambling = 0; scrambling < scramblings; ++scrambling) {
    TracePair<double, Medium> const pair{scrambled(scene, scrambling), medium};
    exposure.begin(scene.dots.centre[index], scene.dots.radiance_of(index), no_images, 0);
    trace_dot(pair, index, rays, exposure);
    exposure.finish(truth, 0);
    found[scrambling] = truth.displacement_px[0];
  }
  return MeanDisplacement::of(found);
}

/// Width of a dot's image without diffraction and medium: its disc and its blur out of focus [px].
double image_width_px(Scene const& scene) {
  double const sharp = 1 / (1 / scene.setup.lens.focal_length - 1 / scene.setup.z_b());
  double const blur = scene.imaging.entrance_pupil * std::abs(1 - scene.imaging.image_distance / sharp);
  return (2 * scene.dots.half_size * scene.imaging.magnification + blur) / scene.setup.camera.pixel_pitch;
}

/// Measures a scene's errors at its present number of rays; what does not depend on that number is made once.
class RayErrors {
 public:
  explicit RayErrors(Scene const& scene)
      : scene_(scene), spot_(make_spot(scene, airy_)), deflections_(scene, DeflectionPlan(scene, scene.dots)) {
    std::vector<std::size_t> const in_view = dots_in_view(scene);
    levels_ = GreyLevels(scene.setup.camera, in_view.size());
    sample_ = choose_sample(in_view, plan_sample_dots);
    if (deflections_.table().exists()) {
      std::vector<std::size_t> places(sample_.size());
      std::iota(places.begin(), places.end(), std::size_t{0});
      checked_ = choose_sample(places, checked_dots);
      for (std::uint64_t rays = fewest_checking_rays;; rays *= 2) {
        by_rays_ = trace_checked(rays);
        double const variance = mean_variance(by_rays_) / scramblings;  // of their means
        if (variance <= 0.1 * truth_tolerance_px * truth_tolerance_px || rays == most_checking_rays) break;
      }
    }
  }

  RaysPlan measure() const {
    RaysPlan plan;
    plan.rays = scene_.rays_per_dot;
    plan.bits = levels_.bits;
    if (sample_.empty()) return plan;
    OwnedLightModel const light(scene_, scene_.dots, &spot_, deflections_.table());
    int const side = 2 * spot_.half_width() + 49 + static_cast<int>(std::min(image_width_px(scene_), widest_image_px));
    Scatter const scatter = measure_scatter(sample_, levels_, [&](std::size_t dot, int scrambling) {
      Vec2d const at = scene_.to_pixel(scene_.dots.centre[dot]);
      Window const window{static_cast<int>(std::floor(at.x)) - side / 2, static_cast<int>(std::floor(at.y)) - side / 2,
                          side};
      return std::visit(
          [&](auto const& medium) {
            return sample_dot(scene_, scrambled(scene_, scrambling), medium, light.model, dot, window);
          },
          scene_.medium.view);
    });
    plan.truth_error_px = std::sqrt(mean_variance(scatter.displacements) + table_bias(scatter.displacements));
    plan.image_error_levels = levels_.error(scatter);
    return plan;
  }

 private:
  /// Of the dots that are checked, by their rays alone.
  std::vector<MeanDisplacement> trace_checked(std::uint64_t rays) const {
    std::vector<MeanDisplacement> means(checked_.size());
    OwnedLightModel const light(scene_, scene_.dots, nullptr, DeflectionTable{});
    std::visit(
        [&](auto const& medium) {
          parallel_for(means.size(), [&](std::size_t i) {
            means[i] = mean_displacement(scene_, medium, light.model, sample_[checked_[i]], rays);
          });
        },
        scene_.medium.view);
    return means;
  }

  /// Mean square by which the table leads displacements from those of rays alone, the scatter of both taken off [px^2].
  /// @param by_table of the sample
  double table_bias(std::vector<MeanDisplacement> const& by_table) const {
    if (checked_.empty()) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < checked_.size(); ++i) {
      MeanDisplacement const& table = by_table[checked_[i]];
      Vec2d const off = table.mean - by_rays_[i].mean;
      double const bias = 0.5 * dot(off, off) - table.variance_of_mean() - by_rays_[i].variance_of_mean();
      if (std::isfinite(bias)) sum += bias;
    }
    return std::max(0.0, sum / static_cast<double>(checked_.size()));
  }

  Scene const& scene_;
  std::optional<AiryTable> airy_;
  SpotView spot_;
  DeflectionMap deflections_;
  std::vector<std::size_t> sample_, checked_;  // dots; those among them whose table is checked, by their places here
  std::vector<MeanDisplacement> by_rays_;
  GreyLevels levels_{scene_.setup.camera, 0};
};

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

StepPlan plan_step(Scene& scene) {
  return choose_step(scene, [&](double step, auto const& search) {
    StepProbe const probe(scene, step);
    search(probe.probes());
  });
}

StepPlan choose_step(Scene& scene,
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
  use_step(scene, plan);
  return plan;
}

void use_step(Scene& scene, StepPlan const& plan) {
  scene.step = plan.step_mm * unit::millimetre;
  scene.widen_pupil(1.25 * plan.largest_bend);
}

RaysPlan measure_rays(Scene const& scene) { return RayErrors(scene).measure(); }

double rays_seconds(Scene const& scene) {
  // emission, lens and sums; a step of the flow ray; a pixel that a spot is spread over [s]
  constexpr double a_ray = 0.6e-6, a_step = 0.12e-6, a_pixel = 1.4e-9;
  std::optional<AiryTable> airy;
  double const width = 2 * make_spot(scene, airy).half_width() + 1;
  double const ray = a_ray + a_step * scene.steps_across() + frame_count * a_pixel * width * width;
  return static_cast<double>(scene.dots.centre.size()) * ray;
}

RaysPlan plan_rays(Scene& scene) {
  RaysPlan plan;
  plan.bits = std::min(scene.setup.camera.bit_depth, 12);
  if (scene.setup.render.rays_per_dot) {
    scene.rays_per_dot = plan.rays = *scene.setup.render.rays_per_dot;
    return plan;
  }
  RayErrors const errors(scene);
  return choose_rays(
      scene, [&] { return errors.measure(); }, rays_seconds(scene));
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
    excess.push_back(
        std::max(plan.truth_error_px / truth_tolerance_px, plan.image_error_levels / image_tolerance_levels));
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
