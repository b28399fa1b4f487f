#include "cuda/device/device_array.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_patch.cuh"
#include "render/focused_dots/narrow_light.h"
#include "render/focused_dots/square_light.h"

namespace gladstone::cuda::inline focused_dots {
namespace {

using Squares = SquareSums<4>;
constexpr int room = 512;  // shared memory of a warp for numbers of the points that it processes together [doubles]

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

/// Accumulates the light of wide cones. Each block takes the next dot when it has finished one, since the duration
/// differs much between dots.
/// @param next  number of dots that have been taken, in device memory
/// @param room, order  buffers of `points_a_block` elements for each block
__global__ void __launch_bounds__(dot_threads, 3)
    expose_wide_kernel(DotModel const __grid_constant__ model, std::uint64_t const count, DotCone const* const cones,
                       DeviceImages const images, int const side, unsigned long long* const next, ConeLight* const room,
                       unsigned short* const order, std::size_t const points_a_block) {
  extern __shared__ double dynamic[];
  __shared__ __align__(16) unsigned char integral_storage[sizeof(ConeIntegral)];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  __shared__ __align__(16) unsigned char square_storage[sizeof(Squares)];
  __shared__ unsigned long long taken;
  ConeIntegral& whole = *reinterpret_cast<ConeIntegral*>(integral_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  if (threadIdx.x == 0) whole.rims = dynamic + dot_warps * side * side;
  while (true) {
    __syncthreads();
    if (threadIdx.x == 0) taken = atomicAdd(next, 1ull);
    __syncthreads();
    if (taken >= count) return;
    DotCone const& dot = cones[taken];
    if (dot.kind != DotKind::wide) continue;
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

/// Side of a kernel's stamp [px], and the shared memory of a block [bytes].
struct Stamp {
  int side;
  std::size_t shared;
};

/// Returns the largest stamp that fits into shared memory, and permits launches with it.
/// @param other_bytes  shared memory that the kernel needs in addition to the stamp [bytes]
template <class Kernel>
Stamp largest_stamp(Kernel* kernel, DotModel const& model, std::size_t other_bytes) {
  int const side = patch_side(model, most_shared_bytes(kernel) - other_bytes);
  Stamp const stamp{side, patch_bytes(side) + other_bytes};
  allow_shared_bytes(kernel, stamp.shared);
  return stamp;
}

void expose_wide_cones(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images) {
  auto* const kernel = expose_wide_kernel;
  Stamp const stamp = largest_stamp(kernel, model, sizeof(double) * static_cast<std::size_t>(model.rim_count()));
  std::uint64_t const blocks = std::min(count, resident_blocks(kernel, dot_threads, stamp.shared));
  auto const points_a_block = static_cast<std::size_t>(model.most_points());
  DeviceArray<ConeLight> light(blocks * points_a_block, "the points of wide cones");
  DeviceArray<unsigned short> order(light.size(), "the points of wide cones");
  DeviceArray<unsigned long long> next(1, "the number of exposed dots");
  next.zero();
  kernel<<<static_cast<unsigned int>(blocks), dot_threads, stamp.shared>>>(
      model, count, cones, images, stamp.side, next.data(), light.data(), order.data(), points_a_block);
  check_launch("expose_wide_dots");
}

}  // namespace

void expose_dots(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images) {
  if (count == 0) return;
  auto* const kernel = expose_kernel;
  Stamp const stamp = largest_stamp(kernel, model, 0);
  kernel<<<blocks_for(kernel, dot_threads, stamp.shared, count), dot_threads, stamp.shared>>>(model, count, cones,
                                                                                              images, stamp.side);
  check_launch("expose_dots");
  if (model.moment_images.exist()) expose_wide_cones(model, count, cones, images);
}

}  // namespace gladstone::cuda::inline focused_dots
