#pragma once

#include <algorithm>

#include "cuda/focused_dots/order_rays.cuh"
#include "cuda/focused_dots/trace_rays.h"
#include "render/base/contracts.h"

namespace gladstone::cuda {

inline constexpr int trace_threads = 64;

/// Whether sampling a medium reads coefficients, so that neighbours in a warp do well to lie near each other.
template <class Medium>
inline constexpr bool reads_memory = requires(Medium medium) {
  medium.coefficients;
};

/// Blocks that are to fit on a processor: enough warps to hide the latency of loads without spilling registers.
template <class T>
inline constexpr int trace_blocks = sizeof(T) == sizeof(double) ? 6 : 10;

/// TracePair's Exposure on the device: keeps one ray's record and outcome in registers.
template <class T>
struct RecordOneRay {
  TargetImage const& image;
  Vec2<T> centre;
  RayRecord<T> record_of_ray;
  RayStatus status[2] = {RayStatus::alive, RayStatus::alive};
  T bend2 = 0;

  GLADSTONE_HD void record(EmittedRay<T> const& emitted, RayHit<T> const& reference, RayHit<T> const& flow) {
    Vec2d const origin = image.to_pixel({static_cast<double>(centre.x), static_cast<double>(centre.y)});
    record_of_ray = make_record(image, centre, Vec2<T>{static_cast<T>(origin.x), static_cast<T>(origin.y)}, emitted,
                                reference, flow);
    status[0] = reference.status;
    status[1] = flow.status;
    if (flow.status <= RayStatus::vignetted) {
      Vec2<T> const bend = flow.at_lens - emitted.pupil;
      bend2 = dot(bend, bend);
    }
  }
};

/// A ray a thread, round after round, so that a block counts its rays once.
/// What lies in parameters is read there (__grid_constant__), also out of line: no thread copies it to its own memory.
/// @param order the ray that each thread traces, by the place of its record; null: its own
template <class T, class Medium>
__global__ void __launch_bounds__(trace_threads, trace_blocks<T>)
    trace_rays_kernel(TracePair<T, Medium> const __grid_constant__ pair, TargetImage const __grid_constant__ image,
                      Batch const batch, std::uint32_t const* const order, int const rounds,
                      RayRecord<T>* const records, TraceTally* const tally) {
  __shared__ unsigned int counts[2 * ray_status_count];
  if (threadIdx.x < 2 * ray_status_count) counts[threadIdx.x] = 0;
  __syncthreads();
  auto const total = static_cast<std::uint32_t>(batch.dots * batch.rays), rays = static_cast<std::uint32_t>(batch.rays);
  double bend2 = 0;
  for (int round = 0; round < rounds; ++round) {
    std::uint32_t const thread = (blockIdx.x * rounds + round) * trace_threads + threadIdx.x;
    if (thread >= total) break;
    std::uint32_t const place = order ? order[thread] : thread;
    std::uint64_t const dot = batch.first + place / rays;
    RecordOneRay<T> exposure{image, pair.scene.sources.centre[dot]};
    pair.template together<1>({dot, place % rays}, exposure);
    records[place] = exposure.record_of_ray;
    for (int frame = 0; frame < 2; ++frame) {
      atomicAdd(&counts[frame * ray_status_count + static_cast<int>(exposure.status[frame])], 1u);
    }
    bend2 = fmax(bend2, static_cast<double>(exposure.bend2));
  }
  for (int step = 16; step > 0; step /= 2) bend2 = fmax(bend2, __shfl_xor_sync(0xffffffffu, bend2, step));
  if (threadIdx.x % 32 == 0) {
    atomicMax(&tally->largest_bend2, static_cast<unsigned long long>(__double_as_longlong(bend2)));
  }
  __syncthreads();
  if (threadIdx.x < 2 * ray_status_count && counts[threadIdx.x] > 0) {
    atomicAdd(&tally->statuses[0][0] + threadIdx.x, static_cast<unsigned long long>(counts[threadIdx.x]));
  }
}

template <class T>
void trace_rays(SceneView<T> const& view, DeviceMedium<T> const& medium, TargetImage const& image, Batch const& batch,
                RayRecord<T>* records, TraceTally* tally) {
  GLADSTONE_EXPECTS(batch.dots * batch.rays < (std::uint64_t{1} << 32) - (std::uint64_t{1} << 16));
  std::visit(
      [&](auto const& held) {
        using Held = std::remove_cvref_t<decltype(held)>;
        DeviceArray<std::uint32_t> order;
        if constexpr (reads_memory<Held>) order = order_rays(view, held.bounds(), batch);
        // so many rounds that enough blocks are left to share the work evenly
        std::uint64_t const total = batch.dots * batch.rays;
        auto const rounds = static_cast<int>(std::clamp<std::uint64_t>(total >> 21, 1, 16));
        std::uint64_t const rays_a_block = static_cast<std::uint64_t>(trace_threads) * rounds;
        auto const blocks = static_cast<unsigned>((total + rays_a_block - 1) / rays_a_block);
        trace_rays_kernel<T, Held><<<blocks, trace_threads>>>(TracePair<T, Held>{view, held}, image, batch,
                                                              order.data(), rounds, records, tally);
        check_launch("trace_rays");
      },
      medium);
}

}  // namespace gladstone::cuda
