#include "render/rays/trace_particles.h"

#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <numeric>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/spot.h"

namespace gladstone::inline rays {
namespace {

constexpr Vec2d unknown{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

}  // namespace

Rendering empty_rendering(Particles const& particles) {
  Rendering rendering;
  rendering.table = TableState::by_rays;
  GroundTruth& truth = rendering.truth;
  std::size_t const count = particles.size();
  truth.resize(count);
  ParticleTruth& seen = truth.particles;
  std::function<void()> const columns[] = {
      [&] { truth.position_m = particles.place[0]; },      [&] { seen.second_m = particles.place[1]; },
      [&] { seen.diameter_m = particles.diameter; },       [&] { seen.reference_ambient_px.resize(count); },
      [&] { seen.displacement_ambient_px.resize(count); }, [&] { truth.eq9_px.assign(count, unknown); },
      [&] { truth.chief_px.assign(count, unknown); },      [&] { truth.eq9_cone_px.assign(count, unknown); }};
  parallel_for(std::size(columns), [&](std::size_t i) { columns[i](); });
  return rendering;
}

void set_particle(GroundTruth& truth, std::size_t particle, TracedParticleTruth const& seen, std::uint64_t rays) {
  truth.set_hits(particle, seen.truth, 1 / static_cast<double>(rays));
  truth.rays_planned[particle] = static_cast<std::int64_t>(rays);
  CentroidSum<double> const &first = seen.ambient.hits[0], &second = seen.ambient.hits[1];
  bool const there[2] = {first.weight > 0, second.weight > 0};
  truth.particles.reference_ambient_px[particle] = there[0] ? seen.ambient.origin + first.mean() : unknown;
  truth.particles.displacement_ambient_px[particle] = there[0] && there[1] ? second.mean() - first.mean() : unknown;
}

void count_rays(Rendering& rendering) {
  std::vector<std::int64_t> const& planned = rendering.truth.rays_planned;
  rendering.rays = frame_count * std::accumulate(planned.begin(), planned.end(), std::int64_t{0});
}

Rendering trace_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles, ParticleLight light,
                          RenderImages images) {
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  bool const lit = images != RenderImages::no;
  ParticleLaunches const launches(scene, plan, lit ? spot : SpotView{}, images);
  Rendering rendering = empty_rendering(particles);
  std::optional<LightImage> frames[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; lit && frame < frame_count; ++frame) {
    targets[frame] = &frames[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  double const light_per_photon = lit ? 1 / photon_unit(scene, particles, light) : 0;
  double margin = 0;
  std::mutex merge;
  Progress progress(lit ? "tracing particles" : "tracing truth", particles.size());
  with_particles(scene, particles, light, [&](auto const& pulses, auto const& medium) {
    parallel_chunks(particles.size(), 32, [&](std::size_t begin, std::size_t end) {
      ParticleTracer tracer(launches, pulses, medium, lit);
      for (std::size_t i = begin; i < end; ++i) {
        TracedParticleTruth const seen = tracer.trace(i, targets, light_per_photon);
        set_particle(rendering.truth, i, seen, tracer.rays());
      }
      progress.advance(end - begin);
      std::lock_guard const lock(merge);
      margin = std::max(margin, tracer.largest_margin());
      add_counts(rendering.statuses, tracer.statuses());
    });
  });
  count_rays(rendering);
  if (lit) rendering.light = {frames[0]->to_light(), frames[1]->to_light()};
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  rendering.pupil_margin = margin;
  return rendering;
}

}  // namespace gladstone::inline rays
