#include "cuda/device_deflections.h"
#include "cuda/launch.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    deflect_kernel(SceneView<double> const open, Medium const medium, DeflectionTable const plan,
                   DeflectionLattice const lattice, int const axis, Vec2d* const displacements, Vec2d* const bends) {
  long long const stride = static_cast<long long>(gridDim.x) * threads;
  for (long long i = blockIdx.x * static_cast<long long>(threads) + threadIdx.x; i < lattice.size(); i += stride) {
    Vec2d const q = lattice.node(static_cast<int>(i % lattice.columns), static_cast<int>(i / lattice.columns));
    Deflection const here = node_deflection(open, medium, plan, q, axis);
    displacements[i] = here.displacement;
    bends[i] = here.bend;
  }
}

}  // namespace

DeviceDeflections::DeviceDeflections(Scene const& scene, DeflectionPlan const& plan,
                                     DeviceMedium<double> const& medium) {
  if (!plan.wanted) return;
  SceneView<double> const open = open_view(scene);
  table_ = plan.table;
  for (int axis = -1; axis < 2; ++axis) {
    DeflectionLattice& lattice = table_.lattice(axis);
    auto const size = static_cast<std::size_t>(lattice.size());
    DeviceArray<Vec2d>&displacements = displacements_[axis + 1], &bends = bends_[axis + 1];
    displacements = DeviceArray<Vec2d>(size, "the deflection table");
    bends = DeviceArray<Vec2d>(size, "the deflection table");
    std::visit(
        [&](auto const& held) {
          auto* const kernel = deflect_kernel<std::remove_cvref_t<decltype(held)>>;
          std::uint64_t const blocks = (size + threads - 1) / threads;
          kernel<<<blocks_for(kernel, threads, 0, blocks), threads>>>(open, held, plan.table, lattice, axis,
                                                                      displacements.data(), bends.data());
          check_launch("deflect");
        },
        medium);
    lattice.displacements = displacements.data();
    lattice.bends = bends.data();
  }
}

}  // namespace gladstone::cuda
