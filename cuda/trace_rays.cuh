#pragma once

#include "cuda/launch.h"
#include "cuda/trace_rays.h"

namespace gladstone::cuda {

inline constexpr int trace_threads = 128;

/// Whether sampling a medium reads coefficients, so that neighbours in a warp do well to lie near each other.
template <class Medium>
inline constexpr bool reads_memory = requires(Medium medium) {
  medium.coefficients;
};

/// Blocks that are to fit on a processor: enough warps to hide the latency of loads without spilling registers.
inline constexpr int trace_blocks = 3;

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

/// Rays of one dot that a block traces together.
inline constexpr int chunk_rays = 1024;
inline constexpr int cells_per_side = 16;
inline constexpr int cell_count = cells_per_side * cells_per_side;

/// The rays of a chunk in the order of the cells in which they cross the middle of the medium, so that the threads of
/// a warp read the same coefficients: a counting sort. Which ray is traced where in the order changes no result.
template <class T, class Medium>
struct ChunkOrder {
  unsigned short order[chunk_rays];
  unsigned char cell[chunk_rays];
  unsigned int cursor[cell_count];

  /// @param across half the width of what a dot's rays cover in the middle of the medium [m]
  __device__ void sort(TracePair<T, Medium> const& pair, std::uint64_t dot, std::uint64_t first, int count) {
    Bounds<T> const box = pair.medium.bounds();
    T const middle = T(0.5) * (box.low.z + box.high.z) - pair.scene.sources.plane_z;
    T const way = middle / (pair.scene.bundle.lens_z - pair.scene.sources.plane_z);
    Vec2<T> const centre = pair.scene.sources.centre[dot];
    T const across = way * pair.scene.bundle.pupil_radius + (T(1) - way) * pair.scene.sources.half_size;
    T const cells = across > T(0) ? T(cells_per_side) / (T(2) * across) : T(0);
    for (int i = threadIdx.x; i < cell_count; i += trace_threads) cursor[i] = 0;
    __syncthreads();
    for (int i = threadIdx.x; i < count; i += trace_threads) {
      EmittedRay<T> const emitted = emit(pair.scene.sources, pair.scene.bundle, dot, first + i);
      T const x = (T(1) - way) * (emitted.ray.position.x - centre.x) + way * emitted.pupil.x;
      T const y = (T(1) - way) * (emitted.ray.position.y - centre.y) + way * emitted.pupil.y;
      int const column = min(cells_per_side - 1, max(0, static_cast<int>((x + across) * cells)));
      int const row = min(cells_per_side - 1, max(0, static_cast<int>((y + across) * cells)));
      // there and back, row by row: neighbours in the order are neighbours in the plane
      int const here = row * cells_per_side + (row % 2 == 0 ? column : cells_per_side - 1 - column);
      cell[i] = static_cast<unsigned char>(here);
      atomicAdd(&cursor[here], 1u);
    }
    __syncthreads();
    if (threadIdx.x < 32) {
      // every lane adds up its share of the cells, then the lanes before it
      constexpr int share = cell_count / 32;
      unsigned int sum = 0;
      for (int i = 0; i < share; ++i) sum += cursor[threadIdx.x * share + i];
      unsigned int before = sum;
      for (int step = 1; step < 32; step *= 2) {
        unsigned int const other = __shfl_up_sync(0xffffffffu, before, step);
        if (threadIdx.x >= step) before += other;
      }
      before -= sum;
      for (int i = 0; i < share; ++i) {
        unsigned int const count_here = cursor[threadIdx.x * share + i];
        cursor[threadIdx.x * share + i] = before;
        before += count_here;
      }
    }
    __syncthreads();
    for (int i = threadIdx.x; i < count; i += trace_threads) {
      order[atomicAdd(&cursor[cell[i]], 1u)] = static_cast<unsigned short>(i);
    }
    __syncthreads();
  }
};

/// How a batch's rays are cut into chunks: some of one dot's rays, or all rays of several dots.
struct Chunks {
  std::uint64_t chunks_a_dot, dots_a_chunk, count;

  GLADSTONE_HD explicit Chunks(Batch const& batch)
      : chunks_a_dot((batch.rays + chunk_rays - 1) / chunk_rays),
        dots_a_chunk(2 * batch.rays <= trace_threads ? trace_threads / batch.rays : 1),
        count((batch.dots + dots_a_chunk - 1) / dots_a_chunk * chunks_a_dot) {}
};

template <class T, class Medium>
__global__ void __launch_bounds__(trace_threads, trace_blocks)
    trace_rays_kernel(TracePair<T, Medium> const pair, TargetImage const image, Batch const batch,
                      RayRecord<T>* const records, TraceTally* const tally) {
  __shared__ ChunkOrder<T, Medium> chunk;
  __shared__ unsigned int counts[2 * ray_status_count];
  if (threadIdx.x < 2 * ray_status_count) counts[threadIdx.x] = 0;
  double bend2 = 0;
  Chunks const chunks(batch);
  for (std::uint64_t c = blockIdx.x; c < chunks.count; c += gridDim.x) {
    std::uint64_t const first_dot = c / chunks.chunks_a_dot * chunks.dots_a_chunk;
    std::uint64_t const first = c % chunks.chunks_a_dot * chunk_rays;
    std::uint64_t const dots = min(chunks.dots_a_chunk, batch.dots - first_dot);
    int const count = static_cast<int>(min(std::uint64_t{chunk_rays}, dots * batch.rays - first));
    bool const sorted = reads_memory<Medium> && chunks.dots_a_chunk == 1;
    __syncthreads();
    if (sorted) chunk.sort(pair, batch.first + first_dot, first, count);
    for (int i = threadIdx.x; i < count; i += trace_threads) {
      int const in_chunk = sorted ? chunk.order[i] : i;
      int const aside = chunks.dots_a_chunk == 1 ? 0 : in_chunk / static_cast<int>(batch.rays);
      std::uint64_t const dot_of_batch = first_dot + aside, dot = batch.first + dot_of_batch;
      std::uint64_t const ray = first + in_chunk - aside * batch.rays;
      RecordOneRay<T> exposure{image, pair.scene.sources.centre[dot]};
      pair.template together<1>({dot, ray}, exposure);
      records[dot_of_batch * batch.rays + ray] = exposure.record_of_ray;
      for (int frame = 0; frame < 2; ++frame) {
        atomicAdd(&counts[frame * ray_status_count + static_cast<int>(exposure.status[frame])], 1u);
      }
      bend2 = fmax(bend2, static_cast<double>(exposure.bend2));
    }
  }
  atomicMax(&tally->largest_bend2, static_cast<unsigned long long>(__double_as_longlong(bend2)));
  __syncthreads();
  if (threadIdx.x < 2 * ray_status_count && counts[threadIdx.x] > 0) {
    atomicAdd(&tally->statuses[0][0] + threadIdx.x, static_cast<unsigned long long>(counts[threadIdx.x]));
  }
}

template <class T>
void trace_rays(SceneView<T> const& view, DeviceMedium<T> const& medium, TargetImage const& image, Batch const& batch,
                RayRecord<T>* records, TraceTally* tally) {
  std::visit(
      [&](auto const& held) {
        using Held = std::remove_cvref_t<decltype(held)>;
        auto* const kernel = trace_rays_kernel<T, Held>;
        kernel<<<blocks_for(kernel, trace_threads, 0, Chunks(batch).count), trace_threads>>>(
            TracePair<T, Held>{view, held}, image, batch, records, tally);
        check_launch("trace_rays");
      },
      medium);
}

}  // namespace gladstone::cuda
