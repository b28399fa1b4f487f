#include "render/rays/ray_planning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "render/base/parallel.h"
#include "render/rays/trace_particles.h"
#include "render/scene/ray_scatter.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

constexpr double not_in_picture = std::numeric_limits<double>::quiet_NaN();

/// Rays from the middle of a source to points of the unit disc that its aim disc is.
std::vector<Vec2d> const chief_ray{{0, 0}};
std::vector<Vec2d> const cone{{0, 0}, {0.95, 0}, {0, 0.95}, {-0.95, 0}, {0, -0.95}};

Probe probe_dots(Scene const& scene, std::vector<std::size_t> const& dots, std::vector<Vec2d> const& rays,
                 double step) {
  Probe probe;
  probe.displacement_px.resize(dots.size());
  probe.bend.resize(dots.size());
  CameraView<double> const camera = scene.camera.view();
  TracingOptions<double> options{step, scene.setup.medium.ambient_refractivity(), scene.setup.medium.integrator,
                                 scene.setup.medium.faces};
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(dots.size(), 16, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Vec3d const start = scene.source_place(dots[i]);
            auto const disc = scene.camera.aim_disc(start);
            Vec2d sum{};
            int seen = 0;
            for (std::size_t k = 0; disc && k < rays.size(); ++k) {
              throw_if_interrupted();
              Vec3d const aim = disc->centre + rays[k].x * disc->a + rays[k].y * disc->b;
              Ray<double> const ray{start, normalized(aim - start)};
              RayHit<double> const reference = trace_ray(camera, NoMedium<double>{}, options, ray, 1.0);
              RayHit<double> const flow = trace_ray(camera, medium, options, ray, 1.0);
              if (std::max(reference.status, flow.status) <= RayStatus::vignetted) {
                probe.bend[i] = std::max(probe.bend[i], length(flow.at_lens - reference.at_lens));
              }
              if (!reaches_sensor_plane(reference.status) || !reaches_sensor_plane(flow.status)) continue;
              sum += flow.pixel - reference.pixel;
              ++seen;
            }
            probe.displacement_px[i] = seen > 0 ? sum / static_cast<double>(seen) : Vec2d{};
          }
        });
      },
      scene.medium.view);
  return probe;
}

/// Measures a scene's errors at its present number of rays.
class RayErrors {
 public:
  explicit RayErrors(Scene const& scene)
      : scene_(scene), spot_(make_spot(scene, airy_)), levels_(scene.setup.camera, 0) {
    std::vector<std::size_t> const in_view = dots_in_view(scene);
    levels_ = GreyLevels(scene.setup.camera, in_view.size());
    sample_ = choose_sample(in_view, plan_sample_dots);
    for (std::size_t const dot : sample_) {
      at_.push_back(scene.setup.piv
                        ? scene.camera.project(scene.source_place(dot)).value_or(Vec2d{not_in_picture, not_in_picture})
                        : scene.to_pixel(scene.dots.centre[dot]));
    }
    side_ = 2 * spot_.half_width() + 49 + static_cast<int>(std::min(widest_image_px(), 100.0));
  }

  RaysPlan measure() const {
    RaysPlan plan;
    plan.rays = scene_.rays_per_dot;
    plan.bits = levels_.bits;
    if (sample_.empty()) return plan;
    std::vector<std::size_t> places(sample_.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    Scatter const scatter =
        measure_scatter(places, levels_, [&](std::size_t place, int scrambling) { return sample(place, scrambling); });
    plan.truth_error_px = std::sqrt(mean_variance(scatter.displacements));
    plan.image_error_levels = levels_.error(scatter);
    return plan;
  }

 private:
  Sampled sample(std::size_t place, int scrambling) const {
    Vec2d const at = at_[place];
    if (!std::isfinite(at.x)) return {at, std::vector<double>(static_cast<std::size_t>(frame_count * side_ * side_))};
    int const left = static_cast<int>(std::floor(at.x)) - side_ / 2,
              top = static_cast<int>(std::floor(at.y)) - side_ / 2;
    auto const change = [&](RaysLaunch& launch) {
      launch.choice.seed = repeat_seed(launch.choice.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
      // pixels are counted from the window's corner: the sensor's own first pixel moves, its axis does not
      launch.camera.sensor.columns -= 2 * left;
      launch.camera.sensor.rows -= 2 * top;
    };
    LightImage frames[frame_count] = {{side_, side_}, {side_, side_}};
    LightImage* const images[frame_count] = {&frames[0], &frames[1]};
    DotTruth const truth =
        scene_.setup.piv ? particle(change, sample_[place], images) : dot(change, sample_[place], images);
    Sampled sampled;
    sampled.displacement = truth.hits[1].mean() - truth.hits[0].mean();
    for (LightImage const& frame : frames) {
      Image<double> const light = frame.to_light();
      sampled.light.insert(sampled.light.end(), light.begin(), light.end());
    }
    return sampled;
  }

  template <class Change>
  DotTruth dot(Change const& change, std::size_t source, LightImage* const (&images)[frame_count]) const {
    RaysLaunch launch(scene_, spot_);
    change(launch);
    LambertSources<double> const lambert{scene_.dots.view(-scene_.setup.z_d)};
    return std::visit(
        [&](auto const& medium) {
          return SourceTracer(launch, launch.camera.view(), lambert, medium, true).trace(source, images);
        },
        scene_.medium.view);
  }
  template <class Change>
  DotTruth particle(Change const& change, std::size_t source, LightImage* const (&images)[frame_count]) const {
    ParticleLaunch launch(scene_, spot_);
    change(launch.smooth);
    change(launch.sharp);
    double const light_per_weight = 1 / (static_cast<double>(launch.smooth.rays) * scene_.photon_unit);
    return with_particles(
        scene_, scene_.particles, ParticleLight::scattered, [&](auto const& pulses, auto const& medium) {
          return ParticleTracer(launch, pulses, medium, true).trace(source, images, light_per_weight).truth;
        });
  }

  /// Width of the sample's images without diffraction and medium [px].
  double widest_image_px() const {
    double widest = 0;
    CameraView<double> const camera = scene_.camera.view();
    for (std::size_t const dot : sample_) {
      Vec3d const start = scene_.source_place(dot);
      auto const disc = scene_.camera.aim_disc(start);
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
  std::vector<Vec2d> at_;  // where they lie in the picture [px]
  int side_ = 0;
};

}  // namespace

StepPlan plan_step_by_rays(Scene& scene) {
  StepPlan const plan = choose_step(scene, [&](double step, auto const& search) {
    StepProbes probes;
    probes.dots.resize(scene.source_count());
    std::iota(probes.dots.begin(), probes.dots.end(), std::size_t{0});
    if (probes.dots.size() > probed_dots) {
      Probe const coarse = probe_dots(scene, probes.dots, chief_ray, step);
      probes.largest_bend = coarse.largest_bend();
      probes.dots = largest_of(changes(coarse, probe_dots(scene, probes.dots, chief_ray, step / 2)));
    }
    probes.at = [&](double at) {
      return probe_dots(scene, probes.dots, scene.chief_rays_only() ? chief_ray : cone, at);
    };
    search(probes);
  });
  use_step(scene, plan);
  return plan;
}

RaysPlan measure_rays_by_rays(Scene const& scene) {
  constexpr std::uint64_t most = 4096;
  Scene fewer = scene;
  fewer.rays_per_dot = std::min(scene.rays_per_dot, most);
  RaysPlan plan = RayErrors(fewer).measure();
  double const gain = std::sqrt(static_cast<double>(fewer.rays_per_dot) / static_cast<double>(scene.rays_per_dot));
  plan.truth_error_px *= gain;
  plan.image_error_levels *= gain;
  plan.extrapolated = scene.rays_per_dot > most;
  plan.rays = scene.rays_per_dot;
  return plan;
}

RaysPlan plan_rays_by_rays(Scene& scene) {
  if (auto const given = given_rays(scene.setup)) {
    scene.rays_per_dot = given->rays;
    return *given;
  }
  RayErrors const errors(scene);
  // to the time of a ray through a thin lens comes that of the surfaces, in both frames [s]
  constexpr double a_surface = 60e-9;
  double const surfaces = a_surface * frame_count * static_cast<double>(scene.camera.elements.size());
  double const seconds = rays_seconds(scene) + surfaces * static_cast<double>(scene.source_count());
  return choose_rays(
      scene, [&] { return errors.measure(); }, seconds);
}

}  // namespace gladstone
