#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/ideal_images/ideal_images.h"
#include "render/rays/rays_renderer.h"
#include "render/sensor/detector.h"
#include "tests/scene/planned_scene.h"
#include "tests/support/ideal_pairs.h"

namespace gladstone::bench {
namespace {

enum class Record { no, yes };

Rendering render_pair(Setup const& setup) {
  PlannedScene scene(build_scene(setup));
  if (auto const ideal = build_ideal_images(scene);
      ideal && setup.piv->particles.scattering == ParticleScattering::gaussian) {
    return render_ideal_images(*ideal, scene.particles, ParticleLight::scattered, RenderImages::in_place);
  }
  plan_step(scene);
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  return RaysRenderer().render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered,
                                         RenderImages::in_place);
}

/// Renders pairs with new particles each time: seeds, moves, illuminates and draws them, and computes their truth. No
/// files are written.
/// @param record  whether a camera of 12 bits records the images, with shot and read noise
void pairs(benchmark::State& state, Setup setup, Record record) {
  Progress::enable(false);
  set_thread_count(static_cast<int>(state.range(0)));
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

void ideal_pairs(benchmark::State& state) {
  pairs(state, test::pair_setup(ParticleScattering::gaussian, 1024, 1024), Record::no);
}
BENCHMARK(ideal_pairs)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

void ideal_pairs_with_noise(benchmark::State& state) {
  pairs(state, test::pair_setup(ParticleScattering::gaussian, 1024, 1024), Record::yes);
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
  Setup setup = test::pair_setup(ParticleScattering::mie, 1024, 1024);
  setup.piv->particles.diameter.spread = DiameterSpread::lognormal;
  setup.piv->particles.diameter.width = 0.2;
  pairs(state, setup, Record::no);
}
BENCHMARK(mie_pairs)->ArgName("threads")->Arg(2)->MeasureProcessCPUTime()->UseManualTime()->Iterations(3)->Unit(
    benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
