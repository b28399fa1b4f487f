#include "cuda/device/device_array.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_patch.cuh"
#include "render/focused_dots/narrow_light.h"
#include "render/focused_dots/square_light.h"

namespace gladstone::cuda {
namespace {

using Squares = SquareSums<4>;
constexpr std::uint64_t most_blocks = 1024;  // each has a buffer for the points of a wide cone
constexpr int room = 512;                    // capacity of the numbers of the points that a warp processes together

/// Accumulates the light of a source disc. @tparam orders  1: without moments
template <int orders>
__device__ void accumulate_light(DotModel const& model, Vec2d origin, double light, MomentField const* field,
                                 Patch patch, double (*numbers)[room]) {
  constexpr int most_points = orders > 1 ? 4 : 16;
  int const edges = 2 * model.spot.half_width() + 2;
  patch.begin(origin);
  accumulate_light_by_points<orders, 1>(Block{}, model, origin, light, field, patch, numbers[threadIdx.x / warp_size],
                                        min(most_points, room / point_numbers(orders, edges)));
  patch.flush();
}

__global__ void __launch_bounds__(dot_threads, 6)
    expose_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone const* const cones,
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
      accumulate_light<1>(model, origin, dot.light, nullptr, {images, static_cast<Frame>(frame), light, side}, numbers);
    }
    if (dot.kind != DotKind::narrow) continue;
    constexpr int terms = PlaceRule::terms;
    for (int k = threadIdx.x; k < DisplacementMoments::count * terms; k += dot_threads) {
      field.coefficient[k / terms][k % terms] = dot.field.coefficient[k / terms][k % terms];
    }
    accumulate_light<DisplacementMoments::order + 1>(model, origin + dot.origin, dot.light, &field,
                                                     {images, Frame::flow, light, side}, numbers);
  }
}

__global__ void __launch_bounds__(dot_threads, 4)
    expose_wide_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone const* const cones,
                       DeviceImages const images, int const side, ConeLight* const room, unsigned short* const order,
                       std::size_t const points_a_block) {
  extern __shared__ double dynamic[];
  __shared__ __align__(16) unsigned char integral_storage[sizeof(ConeIntegral)];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  __shared__ __align__(16) unsigned char square_storage[sizeof(Squares)];
  ConeIntegral& whole = *reinterpret_cast<ConeIntegral*>(integral_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  if (threadIdx.x == 0) whole.rims = dynamic + dot_warps * side * side;
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotCone const& dot = cones[i];
    if (dot.kind != DotKind::wide) continue;
    __syncthreads();
    if (threadIdx.x == 0) cone = make_corrected_cone(model, dot);
    __syncthreads();
    ConeLight* const points = room + blockIdx.x * points_a_block;
    integrate_cone(Block{}, model, cone, whole, points);
    Patch patch{images, Frame::flow, dynamic, side};
    patch.begin(model.to_pixel(dot.centre) + dot.origin);
    accumulate_light_by_squares<1>(Block{}, model, dot, cone, whole,
                                   {points, order + blockIdx.x * points_a_block, model.cone.points_of(whole.simple)},
                                   *reinterpret_cast<Squares*>(square_storage), patch);
    patch.flush();
  }
}

/// Launches a kernel with the largest stamp that fits into shared memory.
/// @param beside  additional shared memory after the stamp [bytes]
/// @param more  arguments after the images and the side of the stamp
template <class Kernel, class... More>
void launch(Kernel* kernel, DotModel const& model, std::uint64_t count, DotCone const* cones,
            DeviceImages const& images, std::uint64_t blocks, std::size_t beside, More... more) {
  int const side = patch_side(model, most_shared_bytes(kernel) - beside);
  std::size_t const shared = patch_bytes(side) + beside;
  allow_shared_bytes(kernel, shared);
  kernel<<<blocks_for(kernel, dot_threads, shared, blocks), dot_threads, shared>>>(model, count, cones, images, side,
                                                                                   more...);
  check_launch("expose_dots");
}

}  // namespace

void expose_dots(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images) {
  launch(expose_kernel, model, count, cones, images, count, 0);
  if (!model.moment_images.exist()) return;
  std::uint64_t const blocks = std::min(count, most_blocks);
  auto const points_a_block = static_cast<std::size_t>(model.most_points());
  DeviceArray<ConeLight> light(blocks * points_a_block, "the points of wide cones");
  DeviceArray<unsigned short> order(light.size(), "the points of wide cones");
  std::size_t const rims = sizeof(double) * static_cast<std::size_t>(model.rim_count());
  launch(expose_wide_kernel, model, count, cones, images, blocks, rims, light.data(), order.data(), points_a_block);
}

}  // namespace gladstone::cuda
