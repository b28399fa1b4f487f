#include "cuda/device/launch.h"
#include "cuda/focused_dots/cone_light.cuh"

namespace gladstone::cuda {
namespace {

__global__ void __launch_bounds__(dot_threads, 6)
    expose_cones_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone const* const cones,
                        DeviceImages const images, int const side) {
  extern __shared__ double light[];
  __shared__ SharesOfGroup shares[dot_warps];
  __shared__ MomentField field;
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotCone const& dot = cones[i];
    if (dot.kind == DotKind::left) continue;
    Vec2d const origin = model.to_pixel(dot.centre);
    Patch patch{light, side, 0, 0};
    lay_down_source(model, origin, dot.light, patch, images, Frame::reference, shares);
    if (dot.kind == DotKind::still) lay_down_source(model, origin, dot.light, patch, images, Frame::flow, shares);
    if (dot.kind != DotKind::narrow) continue;
    constexpr int terms = PlaceRule::terms;
    for (int k = threadIdx.x; k < DisplacementMoments::count * terms; k += dot_threads) {
      field.coefficient[k / terms][k % terms] = dot.field.coefficient[k / terms][k % terms];
    }
    patch.begin(origin + dot.origin);
    lay_down_narrow(model, origin + dot.origin, dot.light, field, patch, images, shares);
    patch.flush(images, Frame::flow);
  }
}

}  // namespace

void expose_cones(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images) {
  auto* const kernel = expose_cones_kernel;
  int const side = patch_side(model, most_shared_bytes(kernel));
  std::size_t const shared = patch_bytes(side);
  allow_shared_bytes(kernel, shared);
  kernel<<<blocks_for(kernel, dot_threads, shared, count), dot_threads, shared>>>(model, count, cones, images, side);
  check_launch("expose_cones");
}

}  // namespace gladstone::cuda
