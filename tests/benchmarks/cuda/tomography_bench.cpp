#include <benchmark/benchmark.h>

#include "analysis/tomography/volume_reconstruction.h"
#include "cuda/backend.h"
#include "tests/analysis/tomography/phantom_views.h"

namespace gladstone::bench {
namespace {

/// Ten sweeps of SART with total variation over eight views of side x side lines, in a cube of side^3 nodes.
/// Arguments: side, 1 for the GPU.
void tomography_sweeps(benchmark::State& state) {
  auto const side = static_cast<int>(state.range(0));
  auto const views = tomography::view_blob(8, side, 20e-3, 4e-3);
  RegularGrid const grid = tomography::make_cube(side, 20e-3);
  tomography::SartSettings settings;
  settings.iterations = 10;
  settings.tolerance = 0.0;
  for (auto _ : state) {
    auto const result = state.range(1) != 0 ? reconstruct_volume(views, grid, settings, cuda::make_volume)
                                            : reconstruct_volume(views, grid, settings);
    benchmark::DoNotOptimize(result.value.data());
  }
}
BENCHMARK(tomography_sweeps)
    ->ArgNames({"side", "gpu"})
    ->ArgsProduct({{64, 128}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
