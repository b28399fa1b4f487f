#include <benchmark/benchmark.h>

#include <chrono>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/rays_renderer.h"
#include "tests/benchmarks/bench_scenes.h"
#include "tests/benchmarks/plain_loops.h"

namespace gladstone::bench {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Seconds that images and truth of a scene take on that many threads, ray by ray; no theory.
double seconds_to_render(PlannedScene const& scene, int threads, RenderImages images = RenderImages::yes) {
  set_thread_count(threads);
  auto const start = Clock::now();
  Rendering const rendering = RaysRenderer().render(scene, scene.plan, scene.dots, images, RenderTheory::no);
  double const taken = seconds_since(start);
  benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
  set_thread_count(0);
  return taken;
}

/// One run of the renderer is one iteration; a ray goes through both frames.
void report_rendering(benchmark::State& state, PlannedScene const& scene, int threads,
                      RenderImages images = RenderImages::yes) {
  Progress::enable(false);
  double fastest = 1e300;
  for (auto _ : state) {
    double const taken = seconds_to_render(scene, threads, images);
    fastest = std::min(fastest, taken);
    state.SetIterationTime(taken);
  }
  state.counters["rays/s"] = rays_of(scene) / fastest;
  state.counters["steps/s"] = steps_of(scene) / fastest;
}

/// Sets four iterations; each rendering takes long enough to be timed individually by report_rendering().
void four_renderings(benchmark::internal::Benchmark* run) {
  run->UseManualTime()->Iterations(4)->Unit(benchmark::kMillisecond);
}

constexpr int per_side = 32;
constexpr std::uint64_t rays_per_dot = 64;

void render_volume(benchmark::State& state) {
  PlannedScene scene = volume_scene(static_cast<int>(state.range(0)), per_side, rays_per_dot);
  report_rendering(state, scene, static_cast<int>(state.range(1)));
}
BENCHMARK(render_volume)->ArgNames({"nodes", "threads"})->ArgsProduct({{64, 128}, {1, 2}})->Apply(four_renderings);

void render_volume_truth_only(benchmark::State& state) {
  PlannedScene scene = volume_scene(static_cast<int>(state.range(0)), per_side, rays_per_dot);
  report_rendering(state, scene, 1, RenderImages::no);
}
BENCHMARK(render_volume_truth_only)->ArgName("nodes")->Arg(64)->Apply(four_renderings);

void render_volume_straight(benchmark::State& state) {
  PlannedScene scene = volume_scene(static_cast<int>(state.range(0)), per_side, rays_per_dot);
  scene.setup.medium.integrator = Integrator::straight;
  report_rendering(state, scene, 1);
}
BENCHMARK(render_volume_straight)->ArgName("nodes")->Arg(64)->Apply(four_renderings);

void render_plane(benchmark::State& state) {
  PlannedScene scene = plane_scene(85, rays_per_dot);
  report_rendering(state, scene, static_cast<int>(state.range(0)));
}
BENCHMARK(render_plane)->ArgName("threads")->Arg(1)->Arg(2)->Apply(four_renderings);

/// Renders dots in focus by the fast renderer; the table of deflections is computed anew each time.
void render_focused(benchmark::State& state) {
  Progress::enable(false);
  PlannedScene scene = state.range(0) == 0 ? plane_scene(85, 32) : volume_scene(64, 85, 32);
  for (auto _ : state) {
    auto const start = Clock::now();
    Rendering const rendering =
        FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    state.SetIterationTime(seconds_since(start));
  }
}
BENCHMARK(render_focused)->ArgName("volume")->Arg(0)->Arg(1)->Apply(four_renderings);

void render_empty(benchmark::State& state) {
  PlannedScene scene = table1_scene(85, rays_per_dot);
  plan_step(scene);
  report_rendering(state, scene, 1);
}
BENCHMARK(render_empty)->Apply(four_renderings);

/// Runs the renderer and the plain loop alternately for the same rays, on one thread each; `ratio` is the ratio of
/// their steps per second.
void renderer_against_plain_loop(benchmark::State& state) {
  Progress::enable(false);
  PlannedScene scene = volume_scene(static_cast<int>(state.range(0)), per_side, rays_per_dot);
  auto const& volume = std::get<SplineVolume<double>>(scene.medium.view);
  std::vector<Ray<double>> const rays = entering_rays(scene, volume);
  int const steps = static_cast<int>(std::lround(volume_width / scene.plan.step));
  double plain = 1e300, renderer = 1e300;
  for (auto _ : state) {
    auto const start = Clock::now();
    for (Ray<double> const& ray : rays) benchmark::DoNotOptimize(plain_steps(volume, ray, scene.plan.step, steps));
    plain = std::min(plain, seconds_since(start));
    double const taken = seconds_to_render(scene, 1);
    renderer = std::min(renderer, taken);
    state.SetIterationTime(taken);
  }
  state.counters["plain_steps/s"] = steps_of(scene) / plain;
  state.counters["renderer_steps/s"] = steps_of(scene) / renderer;
  state.counters["ratio"] = plain / renderer;
}
BENCHMARK(renderer_against_plain_loop)
    ->ArgName("nodes")
    ->Arg(64)
    ->Arg(128)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// Renders alternately on one thread and on two threads.
void two_cores_against_one(benchmark::State& state) {
  Progress::enable(false);
  PlannedScene scene = volume_scene(static_cast<int>(state.range(0)), per_side, rays_per_dot);
  double one = 1e300, two = 1e300;
  for (auto _ : state) {
    one = std::min(one, seconds_to_render(scene, 1));
    double const taken = seconds_to_render(scene, 2);
    two = std::min(two, taken);
    state.SetIterationTime(taken);
  }
  state.counters["scaling"] = one / two;
}
BENCHMARK(two_cores_against_one)
    ->ArgName("nodes")
    ->Arg(64)
    ->Arg(128)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
