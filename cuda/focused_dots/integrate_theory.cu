#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_cones.h"

namespace gladstone::cuda::inline focused_dots {
namespace {

constexpr int threads = 128;

struct SummingBlock {
  ConeSum* shared;

  __device__ static int lane() { return static_cast<int>(threadIdx.x); }
  __device__ static constexpr int size() { return threads; }
  __device__ static void poll() {}
  __device__ ConeSum sum(ConeSum const& value) const { return block_sum(value, shared); }
};

template <class Medium>
__global__ void __launch_bounds__(threads)
    integrate_theory_kernel(DotModel const __grid_constant__ model, TheoryModel const theory, Medium const medium,
                            SourcesView<double> const dots, std::uint64_t const count, DotTheory* const out) {
  __shared__ __align__(16) unsigned char storage[threads * sizeof(ConeSum)];
  SummingBlock const block{reinterpret_cast<ConeSum*>(storage)};
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotTheory const found = gladstone::integrate_theory(block, model, theory, medium, dots.centre[i]);
    if (threadIdx.x == 0) out[i] = found;
  }
}

}  // namespace

void integrate_theory(DotModel const& model, TheoryModel const& theory, DeviceMedium const& medium,
                      SourcesView<double> const& dots, std::uint64_t count, DotTheory* out) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = integrate_theory_kernel<std::remove_cvref_t<decltype(held)>>;
        kernel<<<blocks_for(kernel, threads, 0, count), threads>>>(model, theory, held, dots, count, out);
        check_launch("integrate_theory");
      },
      medium);
}

}  // namespace gladstone::cuda::inline focused_dots
