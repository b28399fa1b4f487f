#include <algorithm>

#include "cuda/device/cuda_error.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/device_deflections.h"
#include "render/base/interrupt.h"

namespace gladstone::cuda::inline focused_dots {
namespace {

constexpr int threads = 128;

/// Four adjacent lanes of a warp, which trace one ray each at neighbouring positions in the medium.
struct FourLanes {
  static constexpr int abreast = 1;
  __device__ static int lane() { return static_cast<int>(threadIdx.x) % 4; }
  static __device__ Vec2d of_lane(int which, Vec2d value) {
    int const from = static_cast<int>(threadIdx.x) % 32 / 4 * 4 + which;
    unsigned int const four = 0xfu << (from - which);
    return {__shfl_sync(four, value.x, from), __shfl_sync(four, value.y, from)};
  }
};

/// Computes groups of four table entries. @param first  index of the first group of this launch
template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    deflect_kernel(FocusedSetupView const __grid_constant__ bench, Medium const __grid_constant__ medium,
                   DeflectionTable const __grid_constant__ plan, DeflectionTable::Values const values,
                   long long const first) {
  long long const four = first + (blockIdx.x * static_cast<long long>(threads) + threadIdx.x) / 4;
  if (four < plan.fours()) trace_ray_group(FourLanes{}, bench, medium, plan, values, four);
}

}  // namespace

DeviceDeflections::DeviceDeflections(FocusedDots const& dots, DeflectionTableLayout const& plan,
                                     DeviceMedium const& medium) {
  if (!plan.wanted()) return;
  FocusedSetupView const bench = dots.bench();
  values_ = DeviceArray<std::byte>(plan.table.bytes(), "the deflection table");
  DeflectionTable::Values const values = plan.table.values_in(values_.data());
  std::visit(
      [&](auto const& held) {
        auto* const kernel = deflect_kernel<std::remove_cvref_t<decltype(held)>>;
        constexpr std::size_t fours_a_block = threads / 4;
        std::size_t const all = (static_cast<std::size_t>(plan.table.fours()) + fours_a_block - 1) / fours_a_block;
        double const steps = threads * std::max(1.0, dots.scene().steps_across(dots.plan().step));
        std::size_t const most = std::max<std::size_t>(1, static_cast<std::size_t>(max_steps_per_launch / steps));
        for (std::size_t first = 0; first < all; first += most) {
          throw_if_interrupted();
          auto const blocks = static_cast<unsigned>(std::min(most, all - first));
          kernel<<<blocks, threads>>>(bench, held, plan.table, values, static_cast<long long>(first * fours_a_block));
          check_launch("deflect");
          if (most < all) check(cudaDeviceSynchronize(), "a part of the deflection table");
        }
      },
      medium);
  table_ = plan.table.with(values);
}

}  // namespace gladstone::cuda::inline focused_dots
