#include "render/rays/ray_planning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/trace_particles.h"
#include "render/scene/ray_scatter.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

constexpr double not_in_picture = std::numeric_limits<double>::quiet_NaN();

/// Maximum contribution to the size of pixel windows of both the width and the displacement of images [px].
constexpr double most_window_px = 100;

/// Rays from the centre of a source, as points of the unit disc that is mapped to its entrance pupil.
constexpr std::array chief_ray{Vec2d{0, 0}};
constexpr std::array cone{Vec2d{0, 0}, Vec2d{0.95, 0}, Vec2d{0, 0.95}, Vec2d{-0.95, 0}, Vec2d{0, -0.95}};

Probe probe_dots(Scene const& scene, std::vector<std::size_t> const& dots, std::span<Vec2d const> rays, double step) {
  Probe probe;
  probe.displacement_px.resize(dots.size());
  probe.shift.resize(dots.size());
  CameraView<double> const camera = scene.camera.view();
  TracingOptions<double> options{step, scene.setup.medium.ambient_refractivity(), scene.setup.medium.integrator,
                                 scene.setup.medium.faces};
  Progress progress("choosing the step", dots.size());
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(dots.size(), 16, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Vec3d const start = scene.source_place(dots[i]);
            auto const disc = scene.camera.apparent_pupil(start);
            Vec2d sum{};
            int seen = 0;
            for (std::size_t k = 0; disc && k < rays.size(); ++k) {
              throw_if_interrupted();
              Vec3d const aim = disc->centre + rays[k].x * disc->a + rays[k].y * disc->b;
              Ray<double> const ray{start, normalized(aim - start)};
              RayHit<double> const reference = trace_ray(camera, NoMedium<double>{}, options, ray, 1.0);
              RayHit<double> const flow = trace_ray(camera, medium, options, ray, 1.0);
              if (std::max(reference.status, flow.status) <= RayStatus::vignetted) {
                probe.shift[i] = std::max(probe.shift[i], length(flow.at_lens - reference.at_lens));
              }
              if (!reaches_sensor_plane(reference.status) || !reaches_sensor_plane(flow.status)) continue;
              sum += flow.pixel - reference.pixel;
              ++seen;
            }
            probe.displacement_px[i] = seen > 0 ? sum / static_cast<double>(seen) : Vec2d{};
            progress.advance();
          }
        });
      },
      scene.medium.view);
  return probe;
}

/// Measures the errors of a scene at its current number of rays.
class RayErrors {
 public:
  explicit RayErrors(Scene const& scene)
      : scene_(scene), spot_(make_spot(scene, airy_)), levels_(scene.setup.camera, 0) {
    std::vector<std::size_t> const in_view = dots_in_view(scene);
    CameraSetup const& camera = scene.setup.camera;
    levels_ =
        GreyLevels(camera, static_cast<double>(in_view.size()) / (static_cast<double>(camera.columns) * camera.rows));
    sample_ = choose_sample(in_view, plan_sample_dots);
    double farthest = 0;  // largest distance of an image from its window's centre in either frame [px]
    for (std::size_t const dot : sample_) {
      Vec2d at = scene.setup.piv
                     ? scene.camera.project(scene.source_place(dot)).value_or(Vec2d{not_in_picture, not_in_picture})
                     : scene.to_pixel(scene.dots.centre[dot]);
      if (auto const moved = place_in_flow(dot)) {
        Vec2d const half = 0.5 * (*moved - at);
        if (length(half) < most_window_px / 2) {
          at += half;
          farthest = std::max(farthest, length(half));
        }
      }
      at_.push_back(at);
    }
    side_ = 2 * spot_.half_width() + 49 + static_cast<int>(std::min(widest_image_px(), most_window_px) + 2 * farthest);
  }

  RayBudget measure() {
    RayBudget plan;
    plan.rays = scene_.rays_per_dot;
    plan.bits = levels_.bits;
    if (sample_.empty()) return plan;
    taken_.assign(sample_.size() * budget_scramblings, 0);
    std::vector<std::size_t> places(sample_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    Scatter const scatter =
        measure_scatter(places, levels_, [&](std::size_t place, int scrambling) { return sample(place, scrambling); });
    plan.truth_error_px = std::sqrt(mean_variance(scatter.displacements));
    plan.image_error_levels = levels_.error(scatter);
    plan.rays = *std::max_element(taken_.begin(), taken_.end());
    double const all = std::accumulate(taken_.begin(), taken_.end(), 0.0);
    plan.seconds = all / static_cast<double>(taken_.size()) * rays_seconds(scene_);
    brightest_ = scatter.brightest;
    return plan;
  }
  /// Light of the brightest pixel in the last measurement.
  double brightest() const { return brightest_; }

 private:
  Sampled sample(std::size_t place, int scrambling) {
    Vec2d const at = at_[place];
    if (!std::isfinite(at.x)) return {at, std::vector<double>(static_cast<std::size_t>(frame_count * side_ * side_))};
    int const left = static_cast<int>(std::floor(at.x)) - side_ / 2,
              top = static_cast<int>(std::floor(at.y)) - side_ / 2;
    auto const change = [&](RaysLaunch& launch) {
      launch.choice.seed = repeat_seed(launch.choice.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
      // Pixels are counted from the window's corner: the sensor's first pixel is moved, its axis is not.
      launch.camera.sensor.columns -= 2 * left;
      launch.camera.sensor.rows -= 2 * top;
    };
    LightImage frames[frame_count] = {{side_, side_}, {side_, side_}};
    LightImage* const images[frame_count] = {&frames[0], &frames[1]};
    std::uint64_t rays = 0;
    // Every other scrambling uses the next finer rule: errors that a rotation of the rule does not reveal then appear
    // as scatter.
    bool const finer = scrambling % 2 == 1;
    DotTruth const truth = scene_.setup.piv ? particle(change, sample_[place], images, finer, rays)
                                            : dot(change, sample_[place], images, rays);
    taken_[place * budget_scramblings + static_cast<std::size_t>(scrambling)] = rays;
    Sampled sampled;
    sampled.displacement = truth.hits[1].mean() - truth.hits[0].mean();
    for (LightImage const& frame : frames) {
      Image<double> const light = frame.to_light();
      sampled.light.insert(sampled.light.end(), light.begin(), light.end());
    }
    return sampled;
  }

  template <class Change>
  DotTruth dot(Change const& change, std::size_t source, LightImage* const (&images)[frame_count],
               std::uint64_t& rays) const {
    RaysLaunch launch(scene_, spot_);
    change(launch);
    RaysLadder const ladder = RaysLadder::of_points(scene_, launch, RenderImages::yes);
    LambertSources<double> const lambert{scene_.dots.view(-scene_.setup.z_d)};
    return std::visit(
        [&](auto const& medium) {
          SourceTracer tracer(ladder, launch.camera.view(), lambert, medium, true);
          DotTruth const truth = tracer.trace(source, images);
          rays = tracer.launch().rays;
          return truth;
        },
        scene_.medium.view);
  }
  template <class Change>
  DotTruth particle(Change const& change, std::size_t source, LightImage* const (&images)[frame_count], bool finer,
                    std::uint64_t& rays) const {
    LightImage* const none[frame_count] = {};
    ParticleLaunches launches(scene_, spot_, RenderImages::yes);
    change(launches.sharp);
    launches.ladder.change(change);
    return with_particles(scene_, scene_.particles, ParticleLight::scattered,
                          [&](auto const& pulses, auto const& medium) {
                            ParticleTracer tracer(launches, pulses, medium, true);
                            double const light = 1 / scene_.photon_unit;
                            bool const twice = finer && launches.ladder[0].rule.view();
                            TracedParticleTruth const found = tracer.trace(source, twice ? none : images, light);
                            rays = tracer.rays();
                            return twice ? tracer.trace(source, images, light, tracer.step() + 1).truth : found.truth;
                          });
  }

  /// Returns the pixel position of a source's chief ray in the measurement image [px].
  std::optional<Vec2d> place_in_flow(std::size_t source) const {
    Vec3d const start = scene_.setup.piv ? scene_.particles.place[1][source] : scene_.source_place(source);
    auto const disc = scene_.camera.apparent_pupil(start);
    if (!disc) return {};
    CameraView<double> const camera = scene_.camera.view();
    TracingOptions<double> const tracing = RaysLaunch(scene_, spot_).tracing;
    RayHit<double> const hit = std::visit(
        [&](auto const& medium) {
          return trace_ray(camera, medium, tracing, {start, normalized(disc->centre - start)}, 1.0);
        },
        scene_.medium.view);
    return reaches_sensor_plane(hit.status) ? std::optional(hit.pixel) : std::nullopt;
  }

  /// Returns the largest width of the sample's images without diffraction and medium [px].
  double widest_image_px() const {
    double widest = 0;
    CameraView<double> const camera = scene_.camera.view();
    for (std::size_t const dot : sample_) {
      Vec3d const start = scene_.source_place(dot);
      auto const disc = scene_.camera.apparent_pupil(start);
      if (!disc) continue;
      std::optional<Vec2d> chief;
      for (Vec2d const at : cone) {
        Vec3d const aim = disc->centre + at.x * disc->a + at.y * disc->b;
        RayHit<double> const hit =
            trace_ray(camera, NoMedium<double>{}, TracingOptions<double>{}, {start, normalized(aim - start)}, 1.0);
        if (!reaches_sensor_plane(hit.status)) continue;
        if (!chief) chief = hit.pixel;
        widest = std::max(widest, 2 * length(hit.pixel - *chief));
      }
    }
    return widest + 2 * scene_.dots.half_size * scene_.imaging.magnification / scene_.setup.camera.pixel_pitch;
  }

  Scene const& scene_;
  std::optional<AiryTable> airy_;
  SpotView spot_;
  GreyLevels levels_;
  std::vector<std::size_t> sample_;
  std::vector<Vec2d> at_;             // positions in the image, centred between both frames [px]
  std::vector<std::uint64_t> taken_;  // number of rays by position and scrambling
  double brightest_ = 0;
  int side_ = 0;
};

}  // namespace

IntegrationStep determine_step_by_tracing(Scene const& scene) {
  return choose_step(scene, [&](double step, auto const& search) {
    StepProbes probes;
    probes.dots.resize(scene.source_count());
    std::iota(probes.dots.begin(), probes.dots.end(), std::size_t{0});
    if (probes.dots.size() > probed_dots) {
      Probe const coarse = probe_dots(scene, probes.dots, chief_ray, step);
      probes.largest_shift = coarse.largest_shift();
      probes.dots = largest_of(changes(coarse, probe_dots(scene, probes.dots, chief_ray, step / 2)));
    }
    probes.at = [&](double at) {
      return probe_dots(scene, probes.dots, scene.chief_rays_only() ? std::span<Vec2d const>(chief_ray) : cone, at);
    };
    search(probes);
  });
}

RayBudget measure_errors_by_tracing(Scene const& scene, std::uint64_t most) {
  Scene fewer = scene;
  fewer.adaptive_criteria.reset();
  fewer.rays_per_dot = std::min(scene.rays_per_dot, most);
  RayBudget plan = RayErrors(fewer).measure();
  double const gain = std::sqrt(static_cast<double>(fewer.rays_per_dot) / static_cast<double>(scene.rays_per_dot));
  plan.truth_error_px *= gain;
  plan.image_error_levels *= gain;
  plan.extrapolated = scene.rays_per_dot > most;
  plan.rays = scene.rays_per_dot;
  return plan;
}

AdaptiveRayCriteria determine_adaptive_criteria(Scene const& scene) {
  constexpr std::uint64_t rays = 64;  // accuracy of a few percent for the brightest pixel and thus for a grey level
  CameraSetup const& camera = scene.setup.camera;
  double const full_scale = std::pow(2.0, error_bit_depth(camera)) - 1;
  AdaptiveRayCriteria criteria;
  criteria.brightest_at = 0.9 * full_scale;
  if (camera.absolute_exposure || camera.exposure_e) {
    double const electrons =
        camera.absolute_exposure ? scene.photon_unit * camera.noise.quantum_efficiency : *camera.exposure_e;
    criteria.level = camera.noise.full_well_e / electrons / full_scale;
    return criteria;
  }
  Scene same = scene;
  same.adaptive_criteria.reset();
  same.rays_per_dot = rays;
  RayErrors errors(same);
  errors.measure();
  criteria.level = errors.brightest() / criteria.brightest_at;
  return criteria;
}

RayBudget determine_ray_budget_by_tracing(Scene const& scene) {
  if (auto const given = configured_ray_budget(scene.setup)) return *given;
  return determine_ray_budget_by_tracing(scene, determine_adaptive_criteria(scene));
}

RayBudget determine_ray_budget_by_tracing(Scene const& scene, AdaptiveRayCriteria const& criteria) {
  bool const one_path = scene.chief_rays_only() && (scene.setup.piv || scene.dots.half_size == 0);
  RayBudget plan;
  plan.most = one_path ? 1 : max_rays_per_source(scene);
  plan.adaptive_criteria = criteria;
  Scene const planned = with_rays(scene, plan);
  RayBudget const measured = RayErrors(planned).measure();
  plan.rays = measured.rays;
  plan.truth_error_px = measured.truth_error_px;
  plan.image_error_levels = measured.image_error_levels;
  plan.bits = measured.bits;
  plan.seconds = measured.seconds;
  plan.converged = plan.excess() <= 1;
  plan.rays_wanted = static_cast<double>(plan.rays);
  // For sequences of points and rough media or edges, errors decrease as n^-0.75 or faster.
  if (!plan.converged) plan.rays_wanted *= std::exp2(std::ceil(std::log2(plan.excess()) / 0.75));
  return plan;
}

}  // namespace gladstone
