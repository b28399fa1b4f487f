#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_patch.cuh"
#include "render/focused_dots/narrow_light.h"

namespace gladstone::cuda {
namespace {

constexpr int room = 512;  // numbers of the points that a warp works on together

/// Lays down a source's disc, with moments or without.
template <int orders>
__device__ void lay_down(DotModel const& model, Vec2d origin, double light, MomentField const* field, Patch patch,
                         double (*numbers)[room]) {
  constexpr int most_points = orders > 1 ? 4 : 16;
  int const edges = 2 * model.spot.half_width() + 2;
  patch.begin(origin);
  lay_down_points<orders, 1>(Block{}, model, origin, light, field, patch, numbers[threadIdx.x / warp_size],
                             min(most_points, room / spot_numbers(orders, edges)));
  patch.flush();
}

__global__ void __launch_bounds__(dot_threads, 6)
    expose_cones_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone const* const cones,
                        DeviceImages const images, int const side) {
  extern __shared__ double light[];
  __shared__ double numbers[dot_warps][room];
  __shared__ MomentField field;
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotCone const& dot = cones[i];
    if (dot.kind == DotKind::left) continue;
    Vec2d const origin = model.to_pixel(dot.centre);
    int const frames = dot.kind == DotKind::still ? frame_count : 1;
    for (int frame = 0; frame < frames; ++frame) {
      lay_down<1>(model, origin, dot.light, nullptr, {images, static_cast<Frame>(frame), light, side}, numbers);
    }
    if (dot.kind != DotKind::narrow) continue;
    constexpr int terms = PlaceRule::terms;
    for (int k = threadIdx.x; k < DisplacementMoments::count * terms; k += dot_threads) {
      field.coefficient[k / terms][k % terms] = dot.field.coefficient[k / terms][k % terms];
    }
    lay_down<DisplacementMoments::order + 1>(model, origin + dot.origin, dot.light, &field,
                                             {images, Frame::flow, light, side}, numbers);
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
