#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/trace_rays.cuh"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

struct WeightedSum {
  ConeSum cone;
  __device__ WeightedSum& operator+=(WeightedSum const& o) {
    cone.levered += o.cone.levered;
    cone.weight += o.cone.weight;
    return *this;
  }
};

template <class Medium>
__global__ void __launch_bounds__(threads)
    integrate_dots_kernel(LightModel const __grid_constant__ light, TheoryModel const model,
                          SceneView<double> const view, Medium const medium, Batch const batch, DotTheory* const out) {
  __shared__ __align__(16) unsigned char storage[threads * sizeof(WeightedSum)];
  auto* const shared = reinterpret_cast<WeightedSum*>(storage);
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    std::uint64_t const dot = batch.first + i;
    WeightedSum sum;
    for (std::uint64_t ray = threadIdx.x; ray < theory_rays(light, batch.rays); ray += threads) {
      add_straight_ray(light, model, view, medium, dot, ray, sum.cone);
    }
    sum = block_sum(sum, shared);
    if (threadIdx.x == 0) out[i] = {integrate_chief(model, view, medium, dot), sum.cone};
  }
}

}  // namespace

void integrate_dots(LightModel const& light, TheoryModel const& model, SceneView<double> const& view,
                    DeviceMedium<double> const& medium, Batch const& batch, DotTheory* out) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = integrate_dots_kernel<std::remove_cvref_t<decltype(held)>>;
        kernel<<<blocks_for(kernel, threads, 0, batch.dots), threads>>>(light, model, view, held, batch, out);
        check_launch("integrate_dots");
      },
      medium);
}

}  // namespace gladstone::cuda
