#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "cuda/backend.h"
#include "render/base/progress.h"
#include "tests/benchmarks/bench_scenes.h"
#include "tests/focused_dots/picture_error.h"

namespace gladstone::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Renders again and again, scene in memory to image in memory; a ray goes through both frames.
void report(benchmark::State& state, PlannedScene scene, std::unique_ptr<Renderer> (*make)() = cuda::make_renderer) {
  Progress::enable(false);
  if (!cuda::device_state().usable) {
    state.SkipWithError(cuda::device_state().text.c_str());
    return;
  }
  auto const renderer = make();
  for (int warm = 0; warm < 2; ++warm)
    renderer->render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
  std::vector<double> seconds;
  for (auto _ : state) {
    scene.plan.step = std::nextafter(scene.plan.step, 1.0);  // no table of the last round's serves again
    auto const start = Clock::now();
    Rendering const rendering = renderer->render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2), seconds.end());
  double const median = seconds[seconds.size() / 2];
  state.counters["median_ms"] = 1e3 * median;
  state.counters["Grays/s"] = 1e-9 * rays_of(scene) / median;
}

/// Renders a part of a scene's dots as the whole would be and, with half its step, by 65,536 rays a dot of the general
/// renderer: how far the two are apart in truth [px] and in the images' lit pixels [grey levels of 12 bits, exposed to
/// 90 %], both rms.
void report_accuracy(benchmark::State& state, PlannedScene scene) {
  constexpr std::size_t parts = 128;
  Progress::enable(false);
  if (!cuda::device_state().usable) {
    state.SkipWithError(cuda::device_state().text.c_str());
    return;
  }
  auto const renderer = cuda::make_renderer(), by_rays = cuda::make_rays_renderer();
  PlannedScene few = scene;
  few.plan.rays = 65536;
  few.plan.step /= 2;
  few.dots.centre.clear();
  for (std::size_t i = 0; i < parts; ++i) {
    few.dots.centre.push_back(scene.dots.centre[(2 * i + 1) * scene.dots.centre.size() / (2 * parts)]);
  }
  for (auto _ : state) {
    Rendering const found = renderer->render(scene, scene.plan, few.dots, RenderImages::yes, RenderTheory::no);
    Rendering const exact = by_rays->render(few, few.plan, few.dots, RenderImages::yes, RenderTheory::no);
    double square = 0;
    for (std::size_t i = 0; i < parts; ++i) {
      Vec2d const off = found.truth.displacement_px[i] - exact.truth.displacement_px[i];
      square += 0.5 * dot(off, off);
    }
    state.counters["truth_px"] = std::sqrt(square / parts);
    state.counters["image_levels"] = picture_error(found.light.flow, exact.light.flow).rms_levels;
  }
}

/// Renders case P of data/benchmarks, whose volume is computed by a formula with random numbers.
void case_p(benchmark::State& state) {
  PlannedScene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  report(state, scene);
}
BENCHMARK(case_p)->ArgName("rays")->Arg(16)->Arg(32)->Arg(128)->UseManualTime()->Iterations(7)->Unit(
    benchmark::kMillisecond);

/// Returns the scene with the step of at most two cells that plan_step() chooses, and with rays for an accuracy of half
/// a grey level of 12 bits.
PlannedScene scene_to_accuracy(std::uint64_t rays) {
  PlannedScene scene = volume_scene(64, 85, rays);
  scene.setup.medium.step_mm.reset();
  scene.medium.coarsest_step = 2 * scene.medium.finest;
  plan_step(scene);
  return scene;
}
void case_p_to_accuracy(benchmark::State& state) {
  PlannedScene scene = scene_to_accuracy(static_cast<std::uint64_t>(state.range(0)));
  report(state, scene);
}
BENCHMARK(case_p_to_accuracy)
    ->ArgName("rays")
    ->Arg(16)
    ->Arg(32)
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);

void case_p_accuracy(benchmark::State& state) {
  report_accuracy(state, scene_to_accuracy(static_cast<std::uint64_t>(state.range(0))));
}
BENCHMARK(case_p_accuracy)->ArgName("rays")->Arg(16)->Arg(32)->Iterations(1);

/// Renders case P ray by ray: the general renderer adds the light of every ray to the image.
void case_p_by_rays(benchmark::State& state) {
  PlannedScene scene = volume_scene(64, 85, static_cast<std::uint64_t>(state.range(0)));
  report(state, scene, cuda::make_rays_renderer);
}
BENCHMARK(case_p_by_rays)
    ->ArgName("rays")
    ->Arg(128)
    ->Arg(10000)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// Renders case T: Table 1 on 1024 x 1024 px with the late plane, continued periodically, and 20,480 random dots.
void case_t(benchmark::State& state) {
  PlannedScene scene = plane_scene(0, static_cast<std::uint64_t>(state.range(0)), 1024);
  report(state, scene);
}
BENCHMARK(case_t)->ArgName("rays")->Arg(16)->Arg(32)->Arg(128)->Arg(1024)->UseManualTime()->Iterations(5)->Unit(
    benchmark::kMillisecond);

void case_t_accuracy(benchmark::State& state) {
  report_accuracy(state, plane_scene(0, static_cast<std::uint64_t>(state.range(0)), 1024));
}
BENCHMARK(case_t_accuracy)->ArgName("rays")->Arg(16)->Arg(32)->Iterations(1);

/// Renders 1e9 rays without a field, ray by ray: 100,000 sources with 10,000 rays each.
void no_field_by_rays(benchmark::State& state) {
  PlannedScene scene = table1_scene(316, 10000, 1024);
  plan_step(scene);
  report(state, scene, cuda::make_rays_renderer);
}
BENCHMARK(no_field_by_rays)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
