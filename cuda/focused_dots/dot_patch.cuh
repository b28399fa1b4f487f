#pragma once

#include <algorithm>
#include <cmath>

#include "cuda/device/device_images.cuh"
#include "cuda/focused_dots/dot_cones.h"

/// How a block of threads gathers a dot's light.
namespace gladstone::cuda {

inline constexpr int dot_threads = 128;
inline constexpr int warp_size = 32;
inline constexpr int dot_warps = dot_threads / warp_size;
inline constexpr unsigned int whole_warp = 0xffffffffu;

/// A square piece of a frame in which a block gathers a dot's light, one copy a warp, so that few additions go to the
/// image; what falls beside it does so at once.
struct Patch {
  double* light;  ///< [warp][side][side], whole units
  int side;
  int left, top;  ///< image position of its corner

  __device__ double* of_warp(int warp) const { return light + static_cast<std::size_t>(warp) * side * side; }

  __device__ void begin(Vec2d middle) {
    bool const sound = fabs(middle.x) < 1e8 && fabs(middle.y) < 1e8;
    left = sound ? static_cast<int>(floor(middle.x + 0.5)) - side / 2 : 0;
    top = sound ? static_cast<int>(floor(middle.y + 0.5)) - side / 2 : 0;
    for (int i = threadIdx.x; i < dot_warps * side * side; i += dot_threads) light[i] = 0;
    __syncthreads();
  }

  /// Sends what all warps have gathered to the image.
  __device__ void flush(DeviceImages const& images, Frame frame) const {
    __syncthreads();
    for (int i = threadIdx.x; i < side * side; i += dot_threads) {
      double sum = 0;
      for (int warp = 0; warp < dot_warps; ++warp) sum += of_warp(warp)[i];
      if (sum != 0) add_light(images, frame, left + i % side, top + i / side, sum);
    }
    __syncthreads();
  }
};

/// Room for the column and row shares of a group of deposits, one a warp.
struct SharesOfGroup {
  static constexpr int room = 512;
  double of[room];
};

/// Lays down a source's disc. A warp takes a group of its points, works each out on a lane, its shares of columns and
/// rows included, and then spreads one after the other, a lane a pixel.
/// @param origin image of its centre [px] @param light of all of it [fully lit px]
__device__ inline void lay_down_source(DotModel const& model, Vec2d origin, double light, Patch& patch,
                                       DeviceImages const& images, Frame frame, SharesOfGroup* shares_of_warps) {
  GaussianSpot<double> const& spot = model.spot;
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  int const width = 2 * spot.half_width() + 1, count = model.source.count;
  int const group = min(warp_size, SharesOfGroup::room / (2 * width));
  double* const shares = shares_of_warps[warp].of;
  double* const gathered = patch.of_warp(warp);
  patch.begin(origin);
  for (int base = group * warp; base < count; base += group * dot_warps) {
    Deposit mine;
    if (lane < group && base + lane < count) mine = reference_light(model, origin, light, base + lane);
    if (!(fabs(mine.at.x) < 1e8 && fabs(mine.at.y) < 1e8)) mine = {};
    mine.weight *= images.units_per_weight;
    unsigned int const lit = __ballot_sync(whole_warp, mine.weight != 0);
    int const my_column = static_cast<int>(floor(mine.at.x + 0.5)) - width / 2;
    int const my_row = static_cast<int>(floor(mine.at.y + 0.5)) - width / 2;
    if (mine.weight != 0) {
      double* const of_columns = shares + lane * 2 * width;
      spot.shares(mine.at.x, my_column, width, of_columns);
      spot.shares(mine.at.y, my_row, width, of_columns + width);
      for (int i = 0; i < width; ++i) of_columns[i] *= mine.weight;
    }
    __syncwarp();
    for (int which = 0; which < group; ++which) {
      if ((lit >> which & 1u) == 0) continue;
      int const c0 = __shfl_sync(whole_warp, my_column, which), r0 = __shfl_sync(whole_warp, my_row, which);
      double const* const of_columns = shares + which * 2 * width;
      double const* const of_rows = of_columns + width;
      bool const inside = c0 >= patch.left && r0 >= patch.top && c0 + width <= patch.left + patch.side &&
                          r0 + width <= patch.top + patch.side;
      double* const corner = gathered + (r0 - patch.top) * patch.side + c0 - patch.left;
      for (int r = lane / 8; r < width; r += warp_size / 8) {
        for (int c = lane % 8; c < width; c += 8) {
          double const share = whole_units(of_rows[r] * of_columns[c]);
          if (inside) {
            corner[r * patch.side + c] += share;
          } else {
            add_light(images, frame, c0 + c, r0 + r, share);
          }
        }
      }
      __syncwarp();
    }
  }
  patch.flush(images, frame);
}

inline std::size_t patch_bytes(int side) { return sizeof(double) * dot_warps * side * side; }
/// Side of a patch: wide enough for a dot, its spot and some pixels of spread, as far as a block's shared memory goes.
/// Eight more than a multiple of sixteen, so that four rows of a spot lie in different banks.
/// @param most_bytes that a patch may take
inline int patch_side(DotModel const& model, std::size_t most_bytes) {
  int const width = 2 * model.spot.half_width() + 1;
  int const wanted = width + 2 * static_cast<int>(std::ceil(model.half_size_px())) + 6;
  int side = std::min(56, 8 + (wanted + 7) / 16 * 16);
  while (side > 8 && patch_bytes(side) > most_bytes) side -= 16;
  return side;
}

}  // namespace gladstone::cuda
