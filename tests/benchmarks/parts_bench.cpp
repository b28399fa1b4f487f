#include <benchmark/benchmark.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "render/rays/source_tracer.h"
#include "render/scene/light_patch.h"
#include "render/sensor/diffraction_spot.h"
#include "tests/benchmarks/bench_scenes.h"
#include "tests/benchmarks/plain_loops.h"

namespace gladstone::bench {
namespace {

/// Measures the emission of rays from a dot: Sobol points, sines and square roots.
void emit_rays(benchmark::State& state) {
  PlannedScene const scene = table1_scene(8, 64);
  RaysLaunch const launch(scene, scene.plan, SpotView{});
  LambertSources<double> const lambert{scene.dots.view(-scene.setup.z_d)};
  AimedBundle<double> const bundle = launch.bundle(*launch.sight(lambert.middle(0)), {{}, {}, lambert.reach()}, 0);
  std::uint64_t ray = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(aim_ray(lambert, bundle, ray / 64 % lambert.dots.count, ray % 64));
    ++ray;
  }
  state.counters["rays/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(emit_rays);

/// Measures the distribution of one ray's light over the pixels along one axis, for the point spread function of Table
/// 1.
void spread_over_pixels(benchmark::State& state) {
  GaussianSpot<double> const spot{0.275};
  int const width = 2 * spot.half_width() + 1;
  std::vector<double> shares(static_cast<std::size_t>(width));
  double p = 100.0;
  for (auto _ : state) {
    spot.shares(p, 100 - spot.half_width(), width, shares.data());
    benchmark::DoNotOptimize(shares.data());
    benchmark::ClobberMemory();
    p = p < 100.49 ? p + 0.001 : 99.51;
  }
  state.counters["axes/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(spread_over_pixels);

/// Measures the accumulation of one ray's light in the stamp of its dot.
void deposit_spot(benchmark::State& state) {
  PlannedScene const scene = table1_scene(2, 64);
  std::optional<AiryTable> airy;
  LightPatch patch(make_spot(scene, airy));
  double p = 99.0;
  for (auto _ : state) {
    patch.deposit({p, 101.0 - 0.01 * p}, 1.0, nullptr, 1.0);
    p = p < 101.0 ? p + 0.001 : 99.0;
  }
  benchmark::DoNotOptimize(patch);
  state.counters["deposits/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(deposit_spot);

/// Measures refractivity and gradient at successive points, each of which depends on the result at the previous one.
template <class Medium>
void sample_in_a_row(benchmark::State& state, Medium const& medium, Vec3d start, Vec3d stride) {
  Vec3d p = start;
  int taken = 0;
  for (auto _ : state) {
    IndexSample<double> const s = medium.sample(p);
    p = p + stride + 1e-9 * s.gradient;
    if (++taken == 60) {
      p = start;
      taken = 0;
    }
  }
  benchmark::DoNotOptimize(p);
  state.counters["samples/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
void sample_volume(benchmark::State& state) {
  PlannedScene const scene = volume_scene(64, 2, 1);
  sample_in_a_row(state, std::get<SplineVolume<double>>(scene.medium.view), {1e-3, 2e-3, -16e-3}, {0, 0, 0.5e-3});
}
BENCHMARK(sample_volume);
void sample_plane(benchmark::State& state) {
  PlannedScene const scene = plane_scene(2, 1);
  sample_in_a_row(state, std::get<SplinePlane<double>>(scene.medium.view), {1e-3, 2e-3, -4e-3}, {2e-5, 1e-5, 0.1e-3});
}
BENCHMARK(sample_plane);

/// Measures only the tracing of rays through a 64^3 volume.
void trace_volume(benchmark::State& state) {
  PlannedScene const scene = volume_scene(64, 32, 64);
  auto const& volume = std::get<SplineVolume<double>>(scene.medium.view);
  std::vector<Ray<double>> const rays = rays_of_dots(scene, 7, 1);
  TracingOptions<double> const tracing = build_focused_dots(scene, scene.plan).value().bench().tracing;
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(trace_medium(volume, tracing, rays[next]));
    next = next + 1 < rays.size() ? next + 1 : 0;
  }
  state.counters["steps/s"] =
      benchmark::Counter(63.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(trace_volume);

/// Measures the tracing of several rays together through a volume.
template <int N>
void trace_volume_together(benchmark::State& state) {
  PlannedScene const scene = volume_scene(64, 32, 64);
  auto const& volume = std::get<SplineVolume<double>>(scene.medium.view);
  std::vector<Ray<double>> const all = rays_of_dots(scene, 7, N);
  TracingOptions<double> const tracing = build_focused_dots(scene, scene.plan).value().bench().tracing;
  std::size_t bundle = 0;
  for (auto _ : state) {
    Ray<double> rays[N];
    std::copy_n(all.data() + bundle, N, rays);
    MediumPassage<double> ways[N];
    trace_medium(volume, tracing, rays, ways);
    benchmark::DoNotOptimize(ways);
    bundle = bundle + 2 * N <= all.size() ? bundle + N : 0;
  }
  state.counters["steps/s"] =
      benchmark::Counter(63.0 * N * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(trace_volume_together<2>);
BENCHMARK(trace_volume_together<4>);
BENCHMARK(trace_volume_together<8>);

}  // namespace
}  // namespace gladstone::bench
