#include "render/rays/trace_particles.h"

#include <limits>
#include <mutex>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/scene/particle_scene.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

constexpr Vec2d unknown{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

}  // namespace

Rendering empty_rendering(Particles const& particles, std::uint64_t rays) {
  Rendering rendering;
  rendering.rays = frame_count * static_cast<std::int64_t>(particles.size() * rays);
  rendering.table = TableState::by_rays;
  rendering.method = RenderMethod::rays;
  GroundTruth& truth = rendering.truth;
  std::size_t const count = particles.size();
  truth.resize(count);
  truth.position_m = particles.place[0];
  truth.rays_planned.assign(count, static_cast<std::int64_t>(rays));
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px}) theory->assign(count, unknown);
  truth.particles.second_m = particles.place[1];
  truth.particles.diameter_m = particles.diameter;
  truth.particles.reference_ambient_px.resize(count);
  truth.particles.displacement_ambient_px.resize(count);
  return rendering;
}

void set_particle(GroundTruth& truth, std::size_t particle, ParticleSeen const& seen, double photons_per_weight) {
  truth.set_hits(particle, seen.truth, photons_per_weight);
  CentroidSum<double> const &first = seen.ambient.hits[0], &second = seen.ambient.hits[1];
  bool const there[2] = {first.weight > 0, second.weight > 0};
  truth.particles.reference_ambient_px[particle] = there[0] ? seen.ambient.origin + first.mean() : unknown;
  truth.particles.displacement_ambient_px[particle] = there[0] && there[1] ? second.mean() - first.mean() : unknown;
}

Rendering trace_particles(Scene& scene, Particles const& particles, ParticleLight light, RenderImages images) {
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  bool const lit = images != RenderImages::no;
  ParticleLaunch const launch(scene, lit ? spot : SpotView{});
  std::uint64_t const rays = scene.rays_per_dot;
  Rendering rendering = empty_rendering(particles, rays);
  std::optional<LightImage> frames[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; lit && frame < frame_count; ++frame) {
    targets[frame] = &frames[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  double const photons_per_weight = 1 / static_cast<double>(rays);
  double const light_per_weight = lit ? photons_per_weight / photon_unit(scene, particles, light) : 0;
  double margin = 0;
  std::mutex merge;
  Progress progress(lit ? "tracing particles" : "tracing truth", particles.size());
  with_particles(scene, particles, light, [&](auto const& pulses, auto const& medium) {
    parallel_chunks(particles.size(), 32, [&](std::size_t begin, std::size_t end) {
      ParticleTracer tracer(launch, pulses, medium, lit);
      for (std::size_t i = begin; i < end; ++i) {
        ParticleSeen const seen = tracer.trace(i, targets, light_per_weight);
        set_particle(rendering.truth, i, seen, photons_per_weight);
      }
      progress.advance(end - begin);
      std::lock_guard const lock(merge);
      margin = std::max(margin, tracer.largest_margin());
      for (std::size_t frame = 0; frame < frame_count; ++frame) {
        for (std::size_t status = 0; status < ray_status_count; ++status) {
          rendering.statuses[frame][status] += tracer.statuses()[frame][status];
        }
      }
    });
  });
  if (lit) rendering.light = {frames[0]->to_light(), frames[1]->to_light()};
  if (images == RenderImages::kept) {
    rendering.kept = std::make_shared<HostLight const>(std::move(rendering.light));
    rendering.light = {};
  }
  scene.pupil_margin = margin;
  return rendering;
}

}  // namespace gladstone
