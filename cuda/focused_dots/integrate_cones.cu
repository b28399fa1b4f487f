#include "cuda/device/launch.h"
#include "cuda/focused_dots/cone_light.cuh"

namespace gladstone::cuda {
namespace {

__global__ void __launch_bounds__(dot_threads, 5)
    integrate_cones_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone* const cones,
                           DotFound* const found) {
  __shared__ __align__(16) unsigned char state_storage[sizeof(ConeState)];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  ConeState& state = *reinterpret_cast<ConeState*>(state_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotCone& dot = cones[i];
    if (dot.kind == DotKind::left) continue;
    __syncthreads();
    if (threadIdx.x == 0) cone = cone_of(model, dot);
    __syncthreads();
    integrate_cone(model, cone, state);
    if (!state.sound) {
      if (threadIdx.x == 0) {
        dot.kind = DotKind::left;
        found[i].left = true;
      }
      continue;
    }
    if (threadIdx.x == 0) {
      DotTruth& truth = found[i].truth;
      dot.origin = cone.origin();
      dot.extent = state.extent;
      if (dot.kind == DotKind::narrow) {
        dot.kind = wide_or_narrow(model, state.narrow, truth.origin + cone.origin(), state.extent);
      }
      sum_cone(model, dot.light, cone.origin(), state.moments, state.without_medium, truth);
      if (dot.kind != DotKind::still) {
        Vec2d const square = model.error2(dot.errors, state.simple);
        truth.error = {sqrt(square.x), sqrt(square.y)};
      }
      if (dot.kind == DotKind::still) truth.hits[1] = truth.hits[0];
      truth.path = TruthPath::table;
      found[i].left = dot.kind == DotKind::left;
    }
    constexpr int terms = PlaceRule::terms;
    for (int k = threadIdx.x; state.narrow && k < DisplacementMoments::count * terms; k += dot_threads) {
      dot.field.coefficient[k / terms][k % terms] =
          MomentField::fitted(model.places, state.moments, k / terms, k % terms);
    }
  }
}

}  // namespace

void integrate_cones(DotModel const& model, std::uint64_t count, DotCone* cones, DotFound* found) {
  auto* const kernel = integrate_cones_kernel;
  kernel<<<blocks_for(kernel, dot_threads, 0, count), dot_threads>>>(model, count, cones, found);
  check_launch("integrate_cones");
}

}  // namespace gladstone::cuda
