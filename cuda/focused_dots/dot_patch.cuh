#pragma once

#include <algorithm>
#include <cmath>

#include "cuda/device/device_images.cuh"
#include "cuda/focused_dots/dot_cones.h"
#include "cuda/focused_dots/dot_groups.cuh"

/// Accumulation of a dot's light by a thread block.
namespace gladstone::cuda::inline focused_dots {

/// Square stamp in shared memory in which a block accumulates a dot's light, with one copy per warp, to reduce the
/// number of atomic additions to the image. Light outside the stamp is added to the image directly.
struct Patch {
  DeviceImages const& images;
  Frame frame;
  double* light;  ///< light in whole units: [warp][side][side]
  int side;
  int left = 0, top = 0;  ///< image position of the stamp's corner

  __device__ double* of_warp(int warp) const { return light + static_cast<std::size_t>(warp) * side * side; }
  __device__ double units_per_weight() const { return images.units_per_weight; }

  __device__ void begin(Vec2d middle) {
    bool const sound = fabs(middle.x) < 1e8 && fabs(middle.y) < 1e8;
    left = sound ? static_cast<int>(floor(middle.x + 0.5)) - side / 2 : 0;
    top = sound ? static_cast<int>(floor(middle.y + 0.5)) - side / 2 : 0;
    for (int i = threadIdx.x; i < dot_warps * side * side; i += dot_threads) light[i] = 0;
    __syncthreads();
  }
  /// Adds a PSF, one pixel per lane. @param fill  fill(row, column, line) adds to a pixel's light
  template <int pixels, class Fill>
  __device__ void add(Warp const& warp, Footprint const& spot, Fill const& fill) {
    bool const inside = spot.column >= left && spot.row >= top && spot.column + spot.width <= left + side &&
                        spot.row + spot.width <= top + side;
    double* const corner = of_warp(warp.index()) + (spot.row - top) * side + spot.column - left;
    for (int row = warp.lane() / 8; row < spot.width; row += warp_size / 8) {
      for (int column = warp.lane() % 8; column < spot.width; column += 8) {
        double line[1] = {};
        fill(row, column, line);
        double const share = whole_units(line[0]);
        if (inside) {
          corner[row * side + column] += share;
        } else {
          add_light(images, frame, spot.column + column, spot.row + row, share);
        }
      }
    }
  }
  /// Adds one pixel of a footprint.
  __device__ void add_run(Footprint const& square, int pixel, double const (&units)[1]) {
    int const column = square.column - left + pixel % square.width, row = square.row - top + pixel / square.width;
    double const share = whole_units(units[0]);
    if (column >= 0 && row >= 0 && column < side && row < side) {
      of_warp(threadIdx.x / warp_size)[row * side + column] += share;
    } else {
      add_light(images, frame, left + column, top + row, share);
    }
  }
  /// Adds the light of all warps to the image.
  __device__ void flush() const {
    __syncthreads();
    for (int i = threadIdx.x; i < side * side; i += dot_threads) {
      double sum = 0;
      for (int warp = 0; warp < dot_warps; ++warp) sum += of_warp(warp)[i];
      if (sum != 0) add_light(images, frame, left + i % side, top + i / side, sum);
    }
    __syncthreads();
  }
};

inline std::size_t patch_bytes(int side) { return sizeof(double) * dot_warps * side * side; }
/// Returns the side of a stamp: covers a dot, its PSF and some pixels of displacement, as far as shared memory permits.
/// The side is eight more than a multiple of sixteen, so that four rows of a PSF are in different banks.
/// @param most_bytes  maximum size of the stamp
inline int patch_side(DotModel const& model, std::size_t most_bytes) {
  int const width = 2 * model.spot.half_width() + 1;
  int const wanted = width + 2 * static_cast<int>(std::ceil(model.half_size_px())) + 6;
  int side = std::min(56, 8 + (wanted + 7) / 16 * 16);
  while (side > 8 && patch_bytes(side) > most_bytes) side -= 16;
  return side;
}

}  // namespace gladstone::cuda::inline focused_dots
