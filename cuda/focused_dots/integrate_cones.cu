#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_cones.h"
#include "cuda/focused_dots/dot_groups.cuh"

namespace gladstone::cuda::inline focused_dots {
namespace {

__global__ void __launch_bounds__(dot_threads, 3)
    integrate_cones_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone* const cones,
                           DotFound* const found) {
  extern __shared__ double rims[];
  __shared__ __align__(16) unsigned char integral_storage[sizeof(ConeIntegral)];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  ConeIntegral& whole = *reinterpret_cast<ConeIntegral*>(integral_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  if (threadIdx.x == 0) whole.rims = rims;
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    if (cones[i].kind == DotKind::left) continue;
    __syncthreads();
    if (threadIdx.x == 0) cone = make_corrected_cone(model, cones[i]);
    __syncthreads();
    integrate_cone(Block{}, model, cone, whole, nullptr);
    conclude(Block{}, model, cone.origin(), whole, cones[i], found[i]);
  }
}

}  // namespace

void integrate_cones(DotModel const& model, std::uint64_t count, DotCone* cones, DotFound* found) {
  auto* const kernel = integrate_cones_kernel;
  std::size_t const shared = sizeof(double) * static_cast<std::size_t>(model.rim_count());
  kernel<<<blocks_for(kernel, dot_threads, shared, count), dot_threads, shared>>>(model, count, cones, found);
  check_launch("integrate_cones");
}

}  // namespace gladstone::cuda::inline focused_dots
