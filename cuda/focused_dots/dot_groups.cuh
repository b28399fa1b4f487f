#pragma once

#include "render/focused_dots/moment_images.h"

/// Groups of device threads that process a dot together; counterpart of OneLane on the CPU.
namespace gladstone::cuda::inline focused_dots {

inline constexpr int dot_threads = 128;
inline constexpr int warp_size = 32;
inline constexpr int dot_warps = dot_threads / warp_size;
inline constexpr unsigned int whole_warp = 0xffffffffu;

/// One of the equal groups into which a warp is divided. All threads of the warp must take part in the collective
/// functions.
template <int threads>
struct WarpPart {
  static constexpr bool alone = false;
  int index_, count_;

  __device__ static int lane() { return static_cast<int>(threadIdx.x) % threads; }
  __device__ static constexpr int size() { return threads; }
  __device__ int index() const { return index_; }
  __device__ int count() const { return count_; }
  __device__ static void sync() { __syncwarp(); }
  __device__ static void poll() {}
  __device__ WarpPart<8> eight() const { return {lane() / 8, threads / 8}; }

  /// Returns the sum over the lanes to every lane, in a fixed order.
  template <class Number>
  static __device__ Number sum(Number value) {
#pragma unroll
    for (int step = threads / 2; step > 0; step /= 2) value += __shfl_xor_sync(whole_warp, value, step);
    return value;
  }
  static __device__ Extent spanned(Extent extent) {
    auto const other = [](Vec2d v, int step) -> Vec2d {
      return {__shfl_xor_sync(whole_warp, v.x, step), __shfl_xor_sync(whole_warp, v.y, step)};
    };
    for (int step = threads / 2; step > 0; step /= 2) {
      extent.include(Extent{other(extent.low, step), other(extent.high, step)});
    }
    return extent;
  }
  __device__ static bool all(bool value) { return __all_sync(whole_warp, value); }
  __device__ static bool any(bool value) { return __any_sync(whole_warp, value); }
  struct Same {
    int before, all;
  };
  static __device__ Same same(int key) {
    unsigned const lanes = __match_any_sync(whole_warp, key);
    return {__popc(lanes & ((1u << lane()) - 1u)), __popc(lanes)};
  }
  __device__ static int sum_below(int value, int& all) {
    int sum = value;
    for (int step = 1; step < threads; step *= 2) {
      int const lower = __shfl_up_sync(whole_warp, sum, step);
      if (lane() >= step) sum += lower;
    }
    all = __shfl_sync(whole_warp, sum, threads - 1);
    return sum - value;
  }
};
using Warp = WarpPart<warp_size>;

/// Thread block that processes one dot; its teams are its warps.
struct Block {
  static constexpr bool alone = false;

  __device__ static int lane() { return static_cast<int>(threadIdx.x); }
  __device__ static constexpr int size() { return dot_threads; }
  __device__ static void sync() { __syncthreads(); }
  __device__ static void sync_team() { __syncwarp(); }
  __device__ static void poll() {}
  static __device__ Warp team() { return {lane() / warp_size, dot_warps}; }
  static __device__ WarpPart<8> eight() { return {lane() / 8, dot_threads / 8}; }
  __device__ static int take(int& listed) { return atomicAdd(&listed, 1); }
};

}  // namespace gladstone::cuda::inline focused_dots
