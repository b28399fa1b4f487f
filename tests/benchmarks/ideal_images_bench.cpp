#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/ideal_images/ideal_images.h"
#include "render/rays/ray_planning.h"
#include "render/rays/rays_renderer.h"
#include "render/sensor/detector.h"

namespace gladstone::bench {
namespace {

/// 1 Mpx with 0.05 particles a pixel, images 3.3 px wide (e^-2), no field.
Setup pair_setup(ParticleScattering scattering) {
  Setup setup;
  setup.camera.columns = setup.camera.rows = 1024;
  setup.camera.pixel_pitch = 5e-6;
  setup.lens.f_number = 16;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.particles.scattering = scattering;
  piv.particles.count = ParticleCount::per_pixel;
  piv.particles.amount = 0.05;
  piv.particles.volume = Vec3d{34e-3, 34e-3, 1e-3};
  setup.piv = piv;
  return setup;
}

enum class Record { no, yes };

Rendering render_pair(Setup const& setup) {
  Scene scene = build_scene(setup);
  if (auto const ideal = ideal_images(scene);
      ideal && setup.piv->particles.scattering == ParticleScattering::gaussian) {
    return render_ideal_images(*ideal, scene.particles, ParticleLight::scattered, RenderImages::in_place);
  }
  scene = with_step(scene, determine_step_by_tracing(scene));
  scene = with_rays(scene, determine_ray_budget_by_tracing(scene));
  return RaysRenderer().render_particles(scene, scene.particles, ParticleLight::scattered, RenderImages::in_place);
}

/// Pairs of other particles every time, seeded, moved, lit and drawn, with their truth; nothing is written.
/// @param record whether a camera of 12 bits records them, with shot and read noise
void pairs(benchmark::State& state, Setup setup, Record record) {
  Progress::enable(false);
  set_thread_count(static_cast<int>(state.range(0)));
  setup.camera.bit_depth = 12;
  setup.camera.noise.enabled = record == Record::yes;
  double fastest = 1e300, rays = 0;
  for (auto _ : state) {
    ++setup.piv->particles.seed;
    auto const start = std::chrono::steady_clock::now();
    Rendering const rendering = render_pair(setup);
    if (record == Record::yes) {
      double const exposure = Detector::auto_exposure(setup.camera, rendering.in_place->brightest());
      RecordedFrames const frames = rendering.in_place->record(Detector(setup.camera, exposure));
      benchmark::DoNotOptimize(frames.levels.get());
    }
    double const taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    fastest = std::min(fastest, taken);
    rays = rendering.truth.rays_planned.empty() ? 0 : static_cast<double>(rendering.truth.rays_planned[0]);
    state.SetIterationTime(taken);
  }
  set_thread_count(0);
  state.counters["pairs/s"] = 1 / fastest;
  state.counters["rays"] = rays;
}

void ideal_pairs(benchmark::State& state) { pairs(state, pair_setup(ParticleScattering::gaussian), Record::no); }
BENCHMARK(ideal_pairs)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

void ideal_pairs_with_noise(benchmark::State& state) {
  pairs(state, pair_setup(ParticleScattering::gaussian), Record::yes);
}
BENCHMARK(ideal_pairs_with_noise)
    ->ArgName("threads")
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

/// Renders oil droplets of about 1 um, all of different diameters, with as many rays as the accuracy requires; the time
/// includes the choice of the number.
void mie_pairs(benchmark::State& state) {
  Setup setup = pair_setup(ParticleScattering::mie);
  setup.piv->particles.diameter.spread = DiameterSpread::lognormal;
  setup.piv->particles.diameter.width = 0.2;
  pairs(state, setup, Record::no);
}
BENCHMARK(mie_pairs)->ArgName("threads")->Arg(2)->MeasureProcessCPUTime()->UseManualTime()->Iterations(3)->Unit(
    benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
