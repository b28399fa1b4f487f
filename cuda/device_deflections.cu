#include "cuda/device_deflections.h"
#include "cuda/launch.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

/// One node a thread: neighbours in a warp are neighbours in the medium. First the straight lattice's, then the
/// slopes'.
template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    deflect_kernel(SceneView<double> const open, Medium const medium, DeflectionTable const plan,
                   Vec2d* const displacements, Vec2d* const bends, PupilSlopes* const displacement_slopes,
                   PupilSlopes* const bend_slopes) {
  long long const nodes = plan.straight.size(), all = nodes + plan.sloping.size();
  long long const stride = static_cast<long long>(gridDim.x) * threads;
  for (long long i = blockIdx.x * static_cast<long long>(threads) + threadIdx.x; i < all; i += stride) {
    if (i < nodes) {
      int const columns = plan.straight.columns;
      Vec2d const q = plan.straight.node(static_cast<int>(i % columns), static_cast<int>(i / columns));
      Deflection const node = straight_node(open, medium, plan, q);
      displacements[i] = node.displacement;
      bends[i] = node.bend;
    } else {
      long long const j = i - nodes;
      int const columns = plan.sloping.columns;
      Vec2d const q = plan.sloping.node(static_cast<int>(j % columns), static_cast<int>(j / columns));
      DeflectionSlopes const node = sloping_node(open, medium, plan, q);
      displacement_slopes[j] = node.displacement;
      bend_slopes[j] = node.bend;
    }
  }
}

}  // namespace

DeviceDeflections::DeviceDeflections(Scene const& scene, DotPattern const& sources,
                                     DeviceMedium<double> const& medium) {
  DeflectionPlan const plan(scene, sources);
  if (!plan.wanted) return;
  SceneView<double> const open = open_view(scene);
  auto const nodes = static_cast<std::size_t>(plan.table.straight.size());
  auto const slopes = static_cast<std::size_t>(plan.table.sloping.size());
  displacements_ = DeviceArray<Vec2d>(nodes, "the deflection table");
  bends_ = DeviceArray<Vec2d>(nodes, "the deflection table");
  displacement_slopes_ = DeviceArray<PupilSlopes>(slopes, "the deflection table");
  bend_slopes_ = DeviceArray<PupilSlopes>(slopes, "the deflection table");
  std::visit(
      [&](auto const& held) {
        auto* const kernel = deflect_kernel<std::remove_cvref_t<decltype(held)>>;
        std::uint64_t const blocks = (nodes + slopes + threads - 1) / threads;
        kernel<<<blocks_for(kernel, threads, 0, blocks), threads>>>(open, held, plan.table, displacements_.data(),
                                                                    bends_.data(), displacement_slopes_.data(),
                                                                    bend_slopes_.data());
        check_launch("deflect");
      },
      medium);
  table_ = plan.table;
  table_.displacements = displacements_.data();
  table_.bends = bends_.data();
  table_.displacement_slopes = displacement_slopes_.data();
  table_.bend_slopes = bend_slopes_.data();
}

}  // namespace gladstone::cuda
