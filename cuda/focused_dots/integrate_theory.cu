#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_cones.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

template <class Medium>
__global__ void __launch_bounds__(threads)
    integrate_theory_kernel(DotModel const __grid_constant__ model, TheoryModel const theory, Medium const medium,
                            SourcesView<double> const dots, std::uint64_t const count, DotTheory* const out) {
  __shared__ __align__(16) unsigned char storage[threads * sizeof(ConeSum)];
  auto* const shared = reinterpret_cast<ConeSum*>(storage);
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    ConeSum sum;
    for (int ray = threadIdx.x; ray < theory_rays(model); ray += threads) {
      add_straight_ray(model, theory, medium, dots.centre[i], ray, sum);
    }
    sum = block_sum(sum, shared);
    if (threadIdx.x == 0) out[i] = {integrate_chief(theory, model.bench, medium, dots.centre[i]), sum};
  }
}

}  // namespace

void integrate_theory(DotModel const& model, TheoryModel const& theory, DeviceMedium<double> const& medium,
                      SourcesView<double> const& dots, std::uint64_t count, DotTheory* out) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = integrate_theory_kernel<std::remove_cvref_t<decltype(held)>>;
        kernel<<<blocks_for(kernel, threads, 0, count), threads>>>(model, theory, held, dots, count, out);
        check_launch("integrate_theory");
      },
      medium);
}

}  // namespace gladstone::cuda
