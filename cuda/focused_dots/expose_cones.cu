#include "cuda/device/launch.h"
#include "cuda/focused_dots/cone_light.cuh"

namespace gladstone::cuda {
namespace {

__global__ void __launch_bounds__(dot_threads, 6)
    expose_cones_kernel(LightModel const __grid_constant__ model, SourcesView<double> const sources, Batch const batch,
                        DotCone const* const cones, DeviceImages const images, int const side) {
  extern __shared__ double light[];
  __shared__ SharesOfGroup shares[dot_warps];
  __shared__ MomentField field;
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    DotKind const kind = cones[i].kind;
    if (kind != DotKind::still && kind != DotKind::narrow) continue;
    std::uint64_t const index = batch.first + i;
    DotPlan const plan = DotPlan::make(model, sources.centre[index], sources.radiance ? sources.radiance[index] : 1.0);
    Patch patch{light, side, 0, 0};
    lay_down_reference(model, plan, patch, images, Frame::reference, shares);
    if (kind == DotKind::still) {
      lay_down_reference(model, plan, patch, images, Frame::flow, shares);
    } else {
      constexpr int terms = PlaceRule::terms;
      for (int k = threadIdx.x; k < DisplacementMoments::count * terms; k += dot_threads) {
        field.coefficient[k / terms][k % terms] = cones[i].field.coefficient[k / terms][k % terms];
      }
      patch.begin(plan.origin + cones[i].origin);
      lay_down_narrow(model, plan, field, cones[i].origin, patch, images, shares);
      patch.flush(images, Frame::flow);
    }
  }
}

}  // namespace

void expose_cones(LightModel const& model, SourcesView<double> const& sources, Batch const& batch, DotCone const* cones,
                  DeviceImages const& images) {
  auto* const kernel = expose_cones_kernel;
  int const side = patch_side(model, most_shared_bytes(kernel));
  std::size_t const shared = patch_bytes(side);
  allow_shared_bytes(kernel, shared);
  kernel<<<blocks_for(kernel, dot_threads, shared, batch.dots), dot_threads, shared>>>(model, sources, batch, cones,
                                                                                       images, side);
  check_launch("expose_cones");
}

}  // namespace gladstone::cuda
