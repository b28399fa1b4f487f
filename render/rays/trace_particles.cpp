#include "render/rays/trace_particles.h"

#include <mutex>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/scene/spot.h"

namespace gladstone {
namespace {

/// Truth of so many particles, to be filled in.
GroundTruth empty_truth(Particles const& particles, std::uint64_t rays) {
  GroundTruth truth;
  std::size_t const count = particles.size();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  truth.resize(count);
  truth.position_m = particles.place[0];
  truth.rays_planned.assign(count, static_cast<std::int64_t>(rays));
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px}) theory->assign(count, {nan, nan});
  truth.particles.second_m = particles.place[1];
  truth.particles.diameter_m = particles.diameter;
  truth.particles.reference_ambient_px.resize(count);
  truth.particles.displacement_ambient_px.resize(count);
  return truth;
}

void set_ambient(GroundTruth& truth, std::size_t particle, DotTruth const& found) {
  GroundTruth one;
  one.resize(1);
  one.set_hits(0, found, 1);
  truth.particles.reference_ambient_px[particle] = one.reference_px[0];
  truth.particles.displacement_ambient_px[particle] = one.displacement_px[0];
}

}  // namespace

Rendering trace_particles(Scene& scene, Particles const& particles, ParticleLight light, RenderImages images) {
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  bool const lit = images != RenderImages::no;
  ParticleLaunch const launch(scene, lit ? spot : SpotView{});
  std::uint64_t const rays = scene.rays_per_dot;
  Rendering rendering;
  rendering.truth = empty_truth(particles, rays);
  rendering.rays = frame_count * static_cast<std::int64_t>(particles.size() * rays);
  rendering.table = TableState::by_rays;
  rendering.method = RenderMethod::rays;
  std::optional<LightImage> frames[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; lit && frame < frame_count; ++frame) {
    targets[frame] = &frames[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  double const photons_per_weight = 1 / static_cast<double>(rays);
  double margin = 0;
  std::mutex merge;
  Progress progress(lit ? "tracing particles" : "tracing truth", particles.size());
  with_particles(scene, particles, light, [&](auto const& pulses, auto const& medium) {
    parallel_chunks(particles.size(), 32, [&](std::size_t begin, std::size_t end) {
      ParticleTracer tracer(launch, pulses, medium, lit);
      for (std::size_t i = begin; i < end; ++i) {
        ParticleSeen const seen = tracer.trace(i, targets, photons_per_weight / scene.photon_unit);
        rendering.truth.set_hits(i, seen.truth, photons_per_weight);
        set_ambient(rendering.truth, i, seen.ambient);
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
