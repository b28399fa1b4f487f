#pragma once

#include <algorithm>
#include <cmath>

#include "cuda/device/device_images.cuh"
#include "cuda/focused_dots/expose_dots.h"
#include "render/sensor/exposure.h"

/// How a block of threads gathers a dot's light.
namespace gladstone::cuda {

inline constexpr int dot_threads = 128;
inline constexpr int warp_size = 32;
inline constexpr int dot_warps = dot_threads / warp_size;
inline constexpr unsigned int whole_warp = 0xffffffffu;

/// A record in double, read in pairs of numbers.
inline __device__ RayRecord<double> widened(RayRecord<double> const& ray) { return ray; }
inline __device__ RayRecord<double> widened(RayRecord<float> const& ray) {
  constexpr int pairs = sizeof(ray) / sizeof(uint2);
  uint2 bits[pairs];
  for (int k = 0; k < pairs; ++k) bits[k] = reinterpret_cast<uint2 const*>(&ray)[k];
  RayRecord<float> here;
  memcpy(&here, bits, sizeof here);
  auto const wide = [](Vec2<float> v) { return Vec2d{v.x, v.y}; };
  return {wide(here.place),      wide(here.pupil), wide(here.arrival),    wide(here.reference),
          wide(here.flow),       here.weight,      here.reference_weight, here.flow_weight,
          here.reference_counts, here.flow_counts, here.leaves_medium,    here.moved};
}

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

/// Lays down `count` deposits: source(i) gives the i-th. A warp takes a group of them, works each out on a lane, its
/// shares of columns and rows included, and then spreads one after the other, a lane a pixel.
template <class Source>
__device__ void lay_down(SpotView const& spot, Patch const& patch, DeviceImages const& images, Frame frame,
                         SharesOfGroup* shares_of_warps, std::uint64_t count, Source const& source) {
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  int const width = 2 * spot.half_width() + 1;
  bool const is_gaussian = spot.model != SpotModel::none && spot.model != SpotModel::airy;
  bool const gaussian = is_gaussian && 2 * width <= SharesOfGroup::room;  // whose shares there is room for
  int const group = gaussian ? min(warp_size, SharesOfGroup::room / (2 * width)) : warp_size;
  double* const shares = shares_of_warps[warp].of;
  double* const gathered = patch.of_warp(warp);
  int const first_row = lane / 8, first_column = lane % 8;
  for (std::uint64_t base = std::uint64_t(group) * warp; base < count; base += group * dot_warps) {
    Deposit mine;
    if (lane < group && base + lane < count) mine = source(base + lane);
    if (!(fabs(mine.at.x) < 1e8 && fabs(mine.at.y) < 1e8)) mine = {};
    mine.weight *= images.units_per_weight;
    unsigned int const lit = __ballot_sync(whole_warp, mine.weight != 0);
    if (lit == 0) continue;
    int const my_column = static_cast<int>(floor(mine.at.x + 0.5)) - width / 2;
    int const my_row = static_cast<int>(floor(mine.at.y + 0.5)) - width / 2;
    if (gaussian && mine.weight != 0) {
      double* const of_columns = shares + lane * 2 * width;
      spot.gaussian.shares(mine.at.x, my_column, width, of_columns);
      spot.gaussian.shares(mine.at.y, my_row, width, of_columns + width);
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
      if (gaussian && inside) {
        for (int r = first_row; r < width; r += 4) {
          for (int c = first_column; c < width; c += 8) {
            corner[r * patch.side + c] += whole_units(of_rows[r] * of_columns[c]);
          }
        }
      } else {
        Deposit const light{{__shfl_sync(whole_warp, mine.at.x, which), __shfl_sync(whole_warp, mine.at.y, which)},
                            __shfl_sync(whole_warp, mine.weight, which)};
        for (int r = first_row; r < width; r += 4) {
          for (int c = first_column; c < width; c += 8) {
            double share = light.weight;
            if (gaussian) {
              share = of_rows[r] * of_columns[c];
            } else if (is_gaussian) {
              double of_row, of_column;
              spot.gaussian.shares(light.at.y, r0 + r, 1, &of_row);
              spot.gaussian.shares(light.at.x, c0 + c, 1, &of_column);
              share *= of_row * of_column;
            }
            if (spot.model == SpotModel::airy) {
              share *= spot.airy.share(light.at.x - (c0 + width / 2), light.at.y - (r0 + width / 2), r, c);
            }
            share = whole_units(share);
            if (inside) {
              corner[r * patch.side + c] += share;
            } else {
              add_light(images, frame, c0 + c, r0 + r, share);
            }
          }
        }
      }
      __syncwarp();
    }
  }
}

inline std::size_t patch_bytes(int side) { return sizeof(double) * dot_warps * side * side; }
/// Side of a patch: wide enough for a dot, its spot and some pixels of spread, as far as a block's shared memory goes.
/// Eight more than a multiple of sixteen, so that four rows of a spot lie in different banks.
/// @param most_bytes that a patch may take
inline int patch_side(LightModel const& model, std::size_t most_bytes) {
  int const width = 2 * model.spot.half_width() + 1;
  int const wanted = width + 2 * static_cast<int>(std::ceil(model.image.half_size_px())) + 6;
  int side = std::min(56, 8 + (wanted + 7) / 16 * 16);
  while (side > 8 && patch_bytes(side) > most_bytes) side -= 16;
  return side;
}

/// The light of a source in the reference frame, by a whole block.
__device__ inline void lay_down_reference(LightModel const& model, DotPlan const& plan, Patch& patch,
                                          DeviceImages const& images, Frame frame, SharesOfGroup* shares) {
  patch.begin(plan.origin);
  lay_down(model.spot, patch, images, frame, shares, model.source.count,
           [&](std::uint64_t k) { return reference_light(model, model.source, plan, static_cast<int>(k)); });
  patch.flush(images, frame);
}

}  // namespace gladstone::cuda
