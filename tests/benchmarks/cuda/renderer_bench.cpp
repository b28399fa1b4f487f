#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "cuda/backend.h"
#include "render/base/progress.h"
#include "tests/benchmarks/bench_scenes.h"

namespace gladstone::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Renders again and again, scene in memory to image in memory; a ray goes through both frames.
void report(benchmark::State& state, Scene& scene, RenderImages images = RenderImages::yes) {
  Progress::enable(false);
  if (!cuda::device_state().usable) {
    state.SkipWithError(cuda::device_state().text.c_str());
    return;
  }
  auto const renderer = cuda::make_renderer();
  for (int warm = 0; warm < 2; ++warm) renderer->render(scene, scene.dots, images, RenderTheory::no);
  std::vector<double> seconds;
  for (auto _ : state) {
    scene.step = std::nextafter(scene.step, 1.0);  // no table of the last round's serves again
    auto const start = Clock::now();
    Rendering const rendering = renderer->render(scene, scene.dots, images, RenderTheory::no);
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2), seconds.end());
  double const median = seconds[seconds.size() / 2];
  state.counters["median_ms"] = 1e3 * median;
  state.counters["Grays/s"] = 1e-9 * rays_of(scene) / median;
}

/// Case P: the baseline's first line, its volume by our seeded formula.
void case_p(benchmark::State& state) {
  Scene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  report(state, scene);
}
BENCHMARK(case_p)->ArgName("rays")->Arg(16)->Arg(32)->Arg(128)->Arg(10000)->UseManualTime()->Iterations(7)->Unit(
    benchmark::kMillisecond);

/// The same to accuracy: the step that plan_step chooses of two cells and less, and rays for half a grey level of 12
/// bits.
void case_p_to_accuracy(benchmark::State& state) {
  Scene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  scene.setup.medium.step_mm.reset();
  scene.medium.coarsest_step = 2 * scene.medium.finest;
  plan_step(scene);
  report(state, scene);
}
BENCHMARK(case_p_to_accuracy)
    ->ArgName("rays")
    ->Arg(16)
    ->Arg(32)
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);

void case_p_truth(benchmark::State& state) {
  Scene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  report(state, scene, RenderImages::no);
}
BENCHMARK(case_p_truth)
    ->ArgName("rays")
    ->Arg(128)
    ->Arg(10000)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// Case P, the preview.
void case_p_single(benchmark::State& state) {
  Scene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  scene.setup.render.precision = Precision::single;
  report(state, scene);
}
BENCHMARK(case_p_single)->ArgName("rays")->Arg(10000)->UseManualTime()->Iterations(5)->Unit(benchmark::kMillisecond);

/// Case P, the preview on trilinear interpolation.
void case_p_single_trilinear(benchmark::State& state) {
  Scene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)), Interpolate::linear);
  scene.setup.render.precision = Precision::single;
  report(state, scene);
}
BENCHMARK(case_p_single_trilinear)
    ->ArgName("rays")
    ->Arg(10000)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// Case T: Table 1 on 1024 x 1024 px, the late plane tiled, 20,449 dots.
void case_t(benchmark::State& state) {
  Scene scene = plane_scene(143, static_cast<std::uint64_t>(state.range(0)), 1024);
  report(state, scene);
}
BENCHMARK(case_t)->ArgName("rays")->Arg(16)->Arg(32)->Arg(128)->Arg(1024)->UseManualTime()->Iterations(5)->Unit(
    benchmark::kMillisecond);

/// 1e9 rays with no field: 100,000 sources of 10,000 rays.
void no_field(benchmark::State& state) {
  Scene scene = table1_scene(316, 10000, 1024);
  plan_step(scene);
  report(state, scene);
}
BENCHMARK(no_field)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
