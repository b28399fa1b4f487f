#include <algorithm>

#include "cuda/device/device_array.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_patch.cuh"
#include "render/focused_dots/square_light.h"

namespace gladstone::cuda {
namespace {

using Squares = SquareSums<4>;
constexpr std::uint64_t most_blocks = 1024;  // each of which has room for the points of a cone

/// Room for one cone's points a block, since a block works on one dot at a time.
struct RoomForCones {
  DeviceArray<ConeLight> light;
  DeviceArray<unsigned short> order;

  /// @param blocks fewer on return where the device has little left, which only costs time
  static RoomForCones make(std::size_t points, int& blocks) {
    for (;; blocks = (blocks + 1) / 2) try {
        std::size_t const all = static_cast<std::size_t>(blocks) * points;
        return {DeviceArray<ConeLight>(all, "the points of wide cones"),
                DeviceArray<unsigned short>(all, "the points of wide cones")};
      } catch (OutOfDeviceMemory const&) {
        if (blocks == 1) throw;
      }
  }
};

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
  for (std::uint64_t i = blockIdx.x; i < count; i += gridDim.x) {
    DotCone const& dot = cones[i];
    if (dot.kind != DotKind::wide) continue;
    __syncthreads();
    if (threadIdx.x == 0) cone = cone_of(model, dot);
    __syncthreads();
    ConeLight* const points = room + blockIdx.x * points_a_block;
    integrate_cone(Block{}, model, cone, whole, points);
    Patch patch{images, Frame::flow, dynamic, side};
    patch.begin(model.to_pixel(dot.centre) + dot.origin);
    lay_down_squares<1>(Block{}, model, dot, cone, whole,
                        {points, order + blockIdx.x * points_a_block, model.cone.points_of(whole.simple)},
                        *reinterpret_cast<Squares*>(square_storage), patch);
    patch.flush();
  }
}

}  // namespace

void expose_wide(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images) {
  if (!model.moment_images.exist()) return;
  auto* const kernel = expose_wide_kernel;
  int const side = patch_side(model, most_shared_bytes(kernel));
  std::size_t const shared = patch_bytes(side);
  allow_shared_bytes(kernel, shared);
  auto const points_a_block = static_cast<std::size_t>(model.most_points());
  int blocks = blocks_for(kernel, dot_threads, shared, std::min(count, most_blocks));
  RoomForCones room = RoomForCones::make(points_a_block, blocks);
  kernel<<<blocks, dot_threads, shared>>>(model, count, cones, images, side, room.light.data(), room.order.data(),
                                          points_a_block);
  check_launch("expose_wide");
}

}  // namespace gladstone::cuda
