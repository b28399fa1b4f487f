#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "cuda/backend.h"
#include "tests/support/ideal_pairs.h"

namespace gladstone::bench {
namespace {

/// Returns the setup of square pairs with a non-uniform flow.
Setup square_pair(ParticleScattering scattering, int side) {
  Setup setup = test::pair_setup(scattering, side, side);
  setup.piv->flow.flow.kind = TaylorGreenFlow{10, 2 * 3.14159265358979 / 10e-3, {}};
  return setup;
}

/// Renders batches of new pairs that remain on the device, as float32.
/// @param scattering  "gaussian", or scattering whose images are blurred by defocus
/// @param state  side of the frames [px], pairs of a batch, whether frames are noisy, whether every pair has its own
///               setup, with the displacement of every pixel
void render_batches(benchmark::State& state, ParticleScattering scattering) {
  cuda::DeviceState const device = cuda::device_state();
  if (!device.usable) {
    state.SkipWithError(device.text.c_str());
    return;
  }
  Setup setup = square_pair(scattering, static_cast<int>(state.range(0)));
  auto const pairs = static_cast<std::size_t>(state.range(1));
  setup.camera.noise.enabled = state.range(2) != 0;
  bool const own_setup = state.range(3) != 0;
  std::vector<OwnedPairModel> const models(own_setup ? pairs : 1, build_pair_model(setup));
  auto const batches = cuda::make_pair_batches(models);
  std::vector<PairSeeds> seeds(pairs);
  std::vector<double> seconds;
  std::uint64_t next = 1;
  auto const render_batch = [&] {
    for (PairSeeds& seed : seeds) {
      seed = {next, next};
      ++next;
    }
    DeviceBuffer const frames = batches->render(seeds, LevelType::float32);
    benchmark::DoNotOptimize(frames.data);
    if (own_setup) benchmark::DoNotOptimize(batches->displacement().data);
  };
  for (int i = 0; i < 3; ++i) render_batch();
  for (auto _ : state) {
    auto const start = std::chrono::steady_clock::now();
    render_batch();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  auto const middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  state.counters["pairs/s"] = static_cast<double>(pairs) / *middle;
}

void pair_batches(benchmark::State& state) { render_batches(state, ParticleScattering::gaussian); }
BENCHMARK(pair_batches)
    ->ArgNames({"side", "pairs", "noise", "own_setup"})
    ->ArgsProduct({{256}, {64, 1024}, {0, 1}, {0, 1}})
    ->ArgsProduct({{512}, {64, 256}, {0, 1}, {0, 1}})
    ->ArgsProduct({{1024}, {8, 64}, {0, 1}, {0, 1}})
    ->UseManualTime()
    ->Iterations(30)
    ->Unit(benchmark::kMillisecond);

/// Renders pairs through an ideal lens, with the light that particles scatter towards the lens, and with their defocus
/// in closed form.
void lens_pair_batches(benchmark::State& state, ParticleScattering scattering) { render_batches(state, scattering); }
void set_lens_arguments(benchmark::internal::Benchmark* lens_pairs) {
  lens_pairs->ArgNames({"side", "pairs", "noise", "own_setup"})
      ->ArgsProduct({{1024}, {64}, {0, 1}, {0, 1}})
      ->UseManualTime()
      ->Iterations(30)
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(lens_pair_batches, lambert, ParticleScattering::lambert)->Apply(set_lens_arguments);
BENCHMARK_CAPTURE(lens_pair_batches, mie, ParticleScattering::mie)->Apply(set_lens_arguments);

}  // namespace
}  // namespace gladstone::bench
