#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstring>

#include "analysis/correlation/lane_correlation.h"
#include "cuda/backend.h"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/cuda_correlator.h"
#include "cuda/device/device_array.h"
#include "cuda/device/device_timer.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone::bench {
namespace {

using cuda::DeviceArray;
using cuda::DeviceImage;

ParticlePair const& particle_pair(int size) {
  static std::vector<std::pair<int, ParticlePair>> made;
  for (auto const& [there, pair] : made)
    if (there == size) return pair;
  ParticleSettings particles;
  particles.columns = particles.rows = size;
  made.emplace_back(size, render_particle_pair(particles, [](Vec2d p) {
                      return Vec2d{1.7 + std::sin(0.01 * p.y), 0.8 * std::cos(0.012 * p.x)};
                    }));
  return made.back().second;
}

/// Image pair in the memory of the device.
struct DevicePairOfImages {
  explicit DevicePairOfImages(int wanted)
      : size(wanted),
        reference(particle_pair(size).reference.data(), particle_pair(size).reference.size(), "benchmark"),
        flow(particle_pair(size).flow.data(), particle_pair(size).flow.size(), "benchmark") {}
  DeviceImage first() const { return {reference.data(), size, size}; }
  DeviceImage second() const { return {flow.data(), size, size}; }
  int size;
  DeviceArray<double> reference, flow;
};

bool no_device(benchmark::State& state) {
  cuda::DeviceState const device = cuda::device_state();
  if (!device.usable) state.SkipWithError(device.text.c_str());
  return !device.usable;
}

void set_rate(benchmark::State& state, std::size_t vectors) {
  state.counters["vectors"] = static_cast<double>(vectors);
  state.counters["vectors/s"] =
      benchmark::Counter(static_cast<double>(vectors), benchmark::Counter::kIsIterationInvariantRate);
}

/// Measures only the kernels that convert windows to subpixel shifts: two launches, 4096 x 4096 px, windows at
/// distances of a quarter of their size.
/// @param range(0) nominal window [px] @param range(1) 1: the kernel specialised for this size; 0: the kernel that
///                 transforms by factors
void correlate_windows(benchmark::State& state, WindowWeighting weighting) {
  if (no_device(state)) return;
  DevicePairOfImages const images(4096);
  int const size = images.size;
  std::size_t const pixels = static_cast<std::size_t>(size) * size;
  InterrogationGrid const grid = make_interrogation_grid(size, size, static_cast<int>(state.range(0)), 0.75);
  AxisWeights const weights(grid, GridAxis::x, size, weighting);
  char const* const purpose = "benchmark";
  DeviceArray<float> const axis(weights.weights().data(), weights.weights().size(), purpose);
  DeviceArray<double> const lags(weights.autocorrelations().data(), weights.autocorrelations().size(), purpose);
  DeviceArray<double> const sums(weights.sums().data(), weights.sums().size(), purpose);
  AxisWeightsView view = weights.view();
  view.weights = axis.data();
  view.autocorrelations = lags.data();
  view.sums = sums.data();
  DeviceArray<cuda::GreyPair> greys(pixels, purpose);
  DeviceArray<float> contrast(1, purpose);
  DeviceArray<cuda::LevelKeys> keys(1, purpose);
  DeviceArray<cuda::WindowPeaks> peaks(grid.size(), purpose);
  DeviceArray<WindowCorrelation> results(grid.size(), purpose);
  int const side = window_side_px(weighting, grid.window_px), radius = grid.window_px / 2;
  int const transform = cuda::factored_size(plane_transform_size(weighting, grid.window_px, radius));
  std::vector<cuda::Complex> const host_roots = cuda::unit_roots(transform);
  DeviceArray<cuda::Complex> const roots(host_roots.data(), host_roots.size(), purpose);
  cuda::DevicePair const pair{greys.data(), size, size};
  cuda::prepare_pair(images.first(), images.second(), keys.data(), contrast.data(), pair);
  cuda::WindowJob const job{.pair = pair,
                            .contrast = contrast.data(),
                            .grid = grid,
                            .x = view,
                            .y = view,
                            .side = side,
                            .margin = (view.size - side) / 2,
                            .size = transform,
                            .roots = roots.data(),
                            .particles = nullptr,
                            .search_radius_px = radius};
  bool const own_kernel = state.range(1) != 0;
  auto const correlate = [&] {
    if (own_kernel)
      job.size == 64 ? cuda::correlate_windows_of_64(job, peaks.data())
                     : cuda::correlate_windows_of_32(job, peaks.data());
    else
      cuda::correlate_windows_by_factors(job, peaks.data());
    cuda::measure_peaks(job, peaks.data(), false, results.data());
  };
  cuda::DeviceTimer timer;
  correlate();
  for (auto _ : state) {
    timer.start();
    correlate();
    state.SetIterationTime(timer.stop());
  }
  set_rate(state, grid.size());
}
BENCHMARK_CAPTURE(correlate_windows, uniform, WindowWeighting::uniform)
    ->Name("cuda_correlate_uniform_windows")
    ->ArgNames({"window", "own"})
    ->Args({32, 0})
    ->UseManualTime()
    ->Iterations(20)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(correlate_windows, gaussian, WindowWeighting::gaussian)
    ->Name("cuda_correlate_windows")
    ->ArgNames({"window", "own"})
    ->Args({32, 1})
    ->Args({16, 1})
    ->ArgsProduct({{64, 48, 32, 24, 20, 16}, {0}})
    ->UseManualTime()
    ->Iterations(20)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond);

/// Measures the time from images on the device to vectors on the host; the memory of the previous pair is reused.
void correlate(benchmark::State& state, CorrelationSettings const& settings, int size) {
  if (no_device(state)) return;
  DevicePairOfImages const images(size);
  cuda::CudaCorrelator const correlator(settings);
  DisplacementField const expected = correlator.correlate(particle_pair(size).reference, particle_pair(size).flow);
  std::size_t vectors = 0;
  for (auto _ : state) {
    auto const begin = std::chrono::steady_clock::now();
    DisplacementField const field = correlator.correlate(images.first(), images.second());
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    vectors = field.size();
    if (std::memcmp(field.displacement_px.data(), expected.displacement_px.data(), vectors * sizeof(Vec2d)) != 0)
      state.SkipWithError("images on the device and on the host gave different vectors");
  }
  set_rate(state, vectors);
}

void single_pass(benchmark::State& state) {
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.overlap = 0.75;
  correlate(state, settings, 4096);
}
BENCHMARK(single_pass)
    ->Name("cuda_correlate_single_pass")
    ->UseManualTime()
    ->Iterations(10)
    ->Unit(benchmark::kMillisecond);

/// Measures the correlation with the passes of the demo. @param range(0) side of the images [px] @param range(1) 1:
/// with correlation statistics
void multi_pass(benchmark::State& state) {
  CorrelationSettings settings;
  if (state.range(1) != 0) settings.uncertainty = "correlation_statistics";
  correlate(state, settings, static_cast<int>(state.range(0)));
}
BENCHMARK(multi_pass)
    ->Name("cuda_correlate_multi_pass")
    ->ArgNames({"size", "sigma"})
    ->Args({512, 0})
    ->Args({1024, 0})
    ->Args({1024, 1})
    ->Args({4096, 0})
    ->UseManualTime()
    ->Iterations(20)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond);

/// Measures the time from images on the device to vectors on the device, for one pair of a batch. @param range(0) side
/// of the images [px]
/// @param range(1) 1: with correlation statistics
void batch(benchmark::State& state) {
  if (no_device(state)) return;
  DevicePairOfImages const images(static_cast<int>(state.range(0)));
  CorrelationSettings settings;
  if (state.range(1) != 0) settings.uncertainty = "correlation_statistics";
  cuda::CudaCorrelator const correlator(settings);
  std::size_t const vectors = correlator.correlate(images.first(), images.second()).size();
  constexpr int pairs = 32;
  cuda::DeviceTimer timer;
  for (auto _ : state) {
    timer.start();
    for (int k = 0; k < pairs; ++k) correlator.enqueue(images.first(), images.second());
    state.SetIterationTime(timer.stop() / pairs);
  }
  set_rate(state, vectors);
}
BENCHMARK(batch)
    ->Name("cuda_correlate_batch")
    ->ArgNames({"size", "sigma"})
    ->Args({1024, 0})
    ->Args({1024, 1})
    ->UseManualTime()
    ->Iterations(5)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
