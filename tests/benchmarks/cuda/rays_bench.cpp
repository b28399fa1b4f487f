#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "cuda/backend.h"
#include "render/base/progress.h"
#include "tests/benchmarks/bench_scenes.h"

namespace gladstone::bench {
namespace {

/// Renders 1e5 points out of focus by 2 px with 1e4 rays each. The light of every ray is added to the images, which
/// remain on the GPU. Rays are counted in each frame.
void render_points_by_rays(benchmark::State& state, Setup setup) {
  Progress::enable(false);
  if (!cuda::device_state().usable) {
    state.SkipWithError(cuda::device_state().text.c_str());
    return;
  }
  setup.camera.columns = setup.camera.rows = 1024;
  PlannedScene scene = points_scene(setup, 90);
  scene.dots.centre.resize(100000);
  auto const renderer = cuda::make_rays_renderer();
  std::vector<double> seconds;
  renderer->render(scene, scene.plan, scene.dots, RenderImages::in_place, RenderTheory::no);
  for (auto _ : state) {
    auto const start = std::chrono::steady_clock::now();
    Rendering const rendering =
        renderer->render(scene, scene.plan, scene.dots, RenderImages::in_place, RenderTheory::no);
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2), seconds.end());
  double const median = seconds[seconds.size() / 2];
  state.counters["ms_a_frame"] = 1e3 * median / frame_count;
  state.counters["Grays/s"] = 1e-9 * frame_count * rays_of(scene) / median;
}

void rays_thin_lens(benchmark::State& state) { render_points_by_rays(state, {}); }
BENCHMARK(rays_thin_lens)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);

void rays_double_gauss(benchmark::State& state) { render_points_by_rays(state, double_gauss_setup()); }
BENCHMARK(rays_double_gauss)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
