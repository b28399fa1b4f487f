#include <algorithm>

#include "cuda/device/cuda_error.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/device_deflections.h"
#include "render/base/interrupt.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

/// One ray a thread, from ray `first` on: first those of the straight lattice, neighbours in a warp neighbours in the
/// medium; then four for every node of the slopes'.
template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    deflect_kernel(BenchView const __grid_constant__ bench, Medium const __grid_constant__ medium,
                   DeflectionTable const __grid_constant__ plan, long long const first, KeptVector* const displacements,
                   KeptVector* const bends, KeptSlopes* const displacement_slopes, KeptSlopes* const bend_slopes) {
  long long const nodes = (plan.straight.size() + 3) / 4 * 4, all = nodes + 4 * plan.sloping.size();
  long long const i = first + blockIdx.x * static_cast<long long>(threads) + threadIdx.x;
  bool const straight = i < nodes;
  long long const node = straight ? i : (i - nodes) / 4;
  SquareLattice const& lattice = straight ? plan.straight : plan.sloping;
  Deflection found[1]{};
  Deflection& here = found[0];
  int const side = static_cast<int>(i % 4);  // of a node's four, which lie side by side in a warp
  if (node < lattice.size()) {
    Vec2d const q[1] = {
        lattice.node(static_cast<int>(node % lattice.columns), static_cast<int>(node / lattice.columns))};
    Vec2d const pupil[1] = {straight ? Vec2d{} : slope_pupil(plan, side)};
    deflect_across(bench, medium, plan.way, q, pupil, found);
  }
  if (straight) {
    if (node < lattice.size()) {
      displacements[node] = KeptVector::of(here.displacement);
      bends[node] = KeptVector::of(here.bend);
    }
    return;
  }
  int const lane = static_cast<int>(threadIdx.x % 32);
  unsigned int const four = 0xfu << (lane - side);
  Deflection sides[4];
  for (int other = 0; other < 4; ++other) {
    int const from = lane - side + other;
    sides[other] = {{__shfl_sync(four, here.displacement.x, from), __shfl_sync(four, here.displacement.y, from)},
                    {__shfl_sync(four, here.bend.x, from), __shfl_sync(four, here.bend.y, from)}};
  }
  if (side == 0 && i < all) {
    DeflectionSlopes const slopes = slopes_of(plan, sides);
    displacement_slopes[node] = slopes.displacement;
    bend_slopes[node] = slopes.bend;
  }
}

}  // namespace

DeviceDeflections::DeviceDeflections(FocusedDots const& dots, DeflectionPlan const& plan,
                                     DeviceMedium<double> const& medium) {
  if (!plan.wanted()) return;
  BenchView const bench = dots.bench();
  auto const nodes = static_cast<std::size_t>(plan.table.straight.size());
  auto const slopes = static_cast<std::size_t>(plan.table.sloping.size());
  values_ = DeviceArray<std::byte>(plan.table.bytes(), "the deflection table");
  auto* const displacements = reinterpret_cast<KeptVector*>(values_.data());
  KeptVector* const bends = displacements + nodes;
  auto* const displacement_slopes = reinterpret_cast<KeptSlopes*>(bends + nodes);
  KeptSlopes* const bend_slopes = displacement_slopes + slopes;
  std::visit(
      [&](auto const& held) {
        auto* const kernel = deflect_kernel<std::remove_cvref_t<decltype(held)>>;
        std::size_t const all = (nodes + 4 + 4 * slopes + threads - 1) / threads;
        double const steps = threads * std::max(1.0, dots.scene().steps_across());
        std::size_t const most = std::max<std::size_t>(1, static_cast<std::size_t>(most_steps_a_launch / steps));
        for (std::size_t first = 0; first < all; first += most) {
          throw_if_interrupted();
          auto const blocks = static_cast<unsigned>(std::min(most, all - first));
          kernel<<<blocks, threads>>>(bench, held, plan.table, static_cast<long long>(first) * threads, displacements,
                                      bends, displacement_slopes, bend_slopes);
          check_launch("deflect");
          if (most < all) check(cudaDeviceSynchronize(), "a part of the deflection table");
        }
      },
      medium);
  table_ = plan.table;
  table_.displacements = displacements;
  table_.bends = bends;
  table_.displacement_slopes = displacement_slopes;
  table_.bend_slopes = bend_slopes;
}

}  // namespace gladstone::cuda
