#pragma once

#include "cuda/device/device_images.cuh"
#include "render/scene/spot.h"

/// PSFs of single rays, added to the image by a warp each.
namespace gladstone::cuda::inline rays {

inline constexpr int warp_size = 32;
inline constexpr unsigned int whole_warp = 0xffffffffu;

/// Adds the PSF of one ray to an image. Called by one full warp.
__device__ inline void add_psf(SpotView const& spot, Vec2d p, double units, int frame, DeviceImages const& images) {
  if (!(fabs(p.x) < 1e8 && fabs(p.y) < 1e8)) return;
  int const half = spot.half_width(), width = 2 * half + 1;
  int const column = static_cast<int>(floor(p.x + 0.5)) - half, row = static_cast<int>(floor(p.y + 0.5)) - half;
  auto const gaussian = [&](double place, int pixel) {
    double const left = (pixel - 0.5 - place) / spot.gaussian.sigma;
    return GaussianSpot<double>::edge_value(left + 1 / spot.gaussian.sigma) - GaussianSpot<double>::edge_value(left);
  };
  for (int k = threadIdx.x % warp_size; k < width * width; k += warp_size) {
    int const i = k % width, j = k / width;
    double share = 1;
    if (spot.model == SpotModel::airy) {
      share = spot.airy.share(p.x - (column + half), p.y - (row + half), j, i);
    } else if (spot.model != SpotModel::none) {
      share = gaussian(p.x, column + i) * gaussian(p.y, row + j);
    }
    add_light(images, static_cast<Frame>(frame), column + i, row + j, whole_units(units * share));
  }
}

/// Adds the PSFs of a warp's rays that are not accumulated elsewhere, one after the other, each to its frame.
/// @tparam Launch  has spot, sign and images
/// @param mine  whether this lane's ray is to be added
template <class Launch>
__device__ void add_psfs(Launch const& launch, bool mine, RayHit<double> const& hit, int frame) {
  for (unsigned int rest = __ballot_sync(whole_warp, mine); rest != 0; rest &= rest - 1) {
    int const lane = __ffs(static_cast<int>(rest)) - 1;
    Vec2d const p{__shfl_sync(whole_warp, hit.pixel.x, lane), __shfl_sync(whole_warp, hit.pixel.y, lane)};
    double const weight = __shfl_sync(whole_warp, hit.weight, lane);
    int const to = __shfl_sync(whole_warp, frame, lane);
    add_psf(launch.spot, p, launch.sign * weight * launch.images.units_per_weight, to, launch.images);
  }
}

}  // namespace gladstone::cuda::inline rays
