#include <benchmark/benchmark.h>

#include <chrono>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/rays_renderer.h"
#include "tests/benchmarks/bench_scenes.h"

namespace gladstone::bench {
namespace {

/// Points out of focus by 2 px, seen by the general renderer: one ray is one ray in one frame, and the light of every
/// ray is laid down. No medium.
void render_points_by_rays(benchmark::State& state, PlannedScene scene) {
  Progress::enable(false);
  set_thread_count(static_cast<int>(state.range(0)));
  double fastest = 1e300;
  for (auto _ : state) {
    auto const start = std::chrono::steady_clock::now();
    Rendering const rendering =
        RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
    double const taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    fastest = std::min(fastest, taken);
    state.SetIterationTime(taken);
  }
  set_thread_count(0);
  double const rays = 2.0 * static_cast<double>(scene.dots.centre.size() * scene.plan.rays);
  state.counters["rays/s"] = rays / fastest;
}

void thin_lens(benchmark::State& state) { render_points_by_rays(state, points_scene({})); }
BENCHMARK(thin_lens)->ArgName("threads")->Arg(1)->Arg(2)->UseManualTime()->Iterations(2)->Unit(benchmark::kMillisecond);

void double_gauss(benchmark::State& state) { render_points_by_rays(state, points_scene(double_gauss_setup())); }
BENCHMARK(double_gauss)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseManualTime()
    ->Iterations(2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
