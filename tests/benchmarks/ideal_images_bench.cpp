#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/ideal_images/ideal_images.h"

namespace gladstone::bench {
namespace {

/// A pair of 1 Mpx with 0.05 particles a pixel, images 3.3 px wide (e^-2), no field and no noise: other particles every
/// time, seeded, moved, lit and drawn, with their truth; nothing is written.
void ideal_pairs(benchmark::State& state) {
  Progress::enable(false);
  set_thread_count(static_cast<int>(state.range(0)));
  Setup setup;
  setup.camera.columns = setup.camera.rows = 1024;
  setup.camera.pixel_pitch = 5e-6;
  setup.lens.f_number = 16;
  setup.z_d = 0;
  PivSetup piv;
  piv.particles.scattering = ParticleScattering::gaussian;
  piv.particles.count = ParticleCount::per_pixel;
  piv.particles.amount = 0.05;
  piv.particles.volume = Vec3d{34e-3, 34e-3, 1e-3};
  setup.piv = piv;
  double fastest = 1e300;
  for (auto _ : state) {
    ++setup.piv->particles.seed;
    auto const start = std::chrono::steady_clock::now();
    Scene const scene = build_scene(setup);
    Rendering const rendering =
        render_ideal_images(*ideal_images(scene), scene.particles, ParticleLight::scattered, RenderImages::kept);
    double const taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    fastest = std::min(fastest, taken);
    state.SetIterationTime(taken);
  }
  set_thread_count(0);
  state.counters["pairs/s"] = 1 / fastest;
}
BENCHMARK(ideal_pairs)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseManualTime()
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
