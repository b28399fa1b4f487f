#pragma once

#include <algorithm>

#include "cuda/device/device_array.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/trace_rays.h"

/// Which rays are traced side by side.
namespace gladstone::cuda {

inline constexpr int order_threads = 256;

/// Rays that are put in order together: those of one dot or of a few that follow each other, or a part of one's.
struct Chunks {
  static constexpr int most_rays = 16384;
  static constexpr int most_dots = 256;

  int dots = 1;              ///< in a chunk
  int rays = 1;              ///< of each of its dots
  std::uint64_t parts = 1;   ///< that a dot's rays are cut into
  std::uint64_t number = 0;  ///< of chunks

  explicit Chunks(Batch const& batch) {
    parts = (batch.rays + most_rays - 1) / most_rays;
    rays = static_cast<int>((batch.rays + parts - 1) / parts);
    dots = std::clamp(most_rays / rays, 1, most_dots);
    number = (batch.dots + static_cast<std::uint64_t>(dots) - 1) / static_cast<std::uint64_t>(dots) * parts;
  }
};

/// The rays of a chunk in the order in which they cross the middle of the medium, strip by strip, there and back, so
/// that the threads of a warp read the same coefficients: a counting sort. Which ray is traced where changes no result.
/// Eight lanes, whose loads a processor serves at once, share a square: a strip's height.
template <class T>
__global__ void __launch_bounds__(order_threads)
    order_rays_kernel(SceneView<T> const scene, Bounds<T> const box, Batch const batch, Chunks const chunks,
                      std::uint32_t* const order) {
  constexpr int most_cells = Chunks::most_rays / 4;
  constexpr int warps = order_threads / 32;
  __shared__ unsigned int cursor[most_cells];
  __shared__ unsigned int warp_sums[warps];
  extern __shared__ unsigned short cell[];  // of each ray

  std::uint64_t const first_dot = blockIdx.x / chunks.parts * static_cast<std::uint64_t>(chunks.dots);
  std::uint64_t const first_ray = blockIdx.x % chunks.parts * static_cast<std::uint64_t>(chunks.rays);
  int const dots = static_cast<int>(min(static_cast<std::uint64_t>(chunks.dots), batch.dots - first_dot));
  int const rays = static_cast<int>(min(static_cast<std::uint64_t>(chunks.rays), batch.rays - first_ray));
  int const count = dots * rays;

  // what the chunk's rays cover in the middle of the medium
  T const middle = T(0.5) * (box.low.z + box.high.z) - scene.sources.plane_z;
  T const way = middle / (scene.bundle.lens_z - scene.sources.plane_z);
  Vec2<T> const* const centre = scene.sources.centre + batch.first + first_dot;
  Vec2<T> low = centre[0], high = centre[0];
  for (int i = 1; i < dots; ++i) {
    low = {min(low.x, centre[i].x), min(low.y, centre[i].y)};
    high = {max(high.x, centre[i].x), max(high.y, centre[i].y)};
  }
  T const reach = fabs(way) * scene.bundle.pupil_radius + fabs(T(1) - way) * scene.sources.half_size;
  Vec2<T> const corner{(T(1) - way) * (way < T(1) ? low.x : high.x) - reach,
                       (T(1) - way) * (way < T(1) ? low.y : high.y) - reach};
  Vec2<T> const size = fabs(T(1) - way) * (high - low) + Vec2<T>{T(2) * reach, T(2) * reach};
  bool const flat = !(size.x > T(0) && size.y > T(0));
  auto const within = [](T x, int most) { return min(max(static_cast<int>(x), 0), most); };
  int const rows = flat ? 1 : 1 + within(sqrt(T(0.125) * T(count) * size.y / size.x), most_cells / 2 - 1);
  int const columns = flat ? 1 : 1 + within(T(2) * sqrt(T(0.125) * T(count) * size.x / size.y), most_cells / rows - 1);
  Vec2<T> const scale = flat ? Vec2<T>{} : Vec2<T>{T(columns) / size.x, T(rows) / size.y};

  for (int i = threadIdx.x; i < most_cells; i += order_threads) cursor[i] = 0;
  __syncthreads();
  for (int i = threadIdx.x; i < count; i += order_threads) {
    std::uint64_t const dot = batch.first + first_dot + static_cast<std::uint64_t>(i / rays);
    EmittedRay<T> const emitted = emit(scene.sources, scene.bundle, dot, first_ray + i % rays);
    T const x = (T(1) - way) * emitted.ray.position.x + way * emitted.pupil.x;
    T const y = (T(1) - way) * emitted.ray.position.y + way * emitted.pupil.y;
    int const column = within((x - corner.x) * scale.x, columns - 1);
    int const row = within((y - corner.y) * scale.y, rows - 1);
    int const here = row * columns + (row % 2 == 0 ? column : columns - 1 - column);
    cell[i] = static_cast<unsigned short>(here);
    atomicAdd(&cursor[here], 1u);
  }
  __syncthreads();

  // every thread adds up its share of the cells, then the threads before it
  constexpr int share = most_cells / order_threads;
  int const lane = threadIdx.x % 32, warp = threadIdx.x / 32;
  unsigned int sum = 0;
  for (int i = 0; i < share; ++i) sum += cursor[threadIdx.x * share + i];
  unsigned int before = sum;
  for (int step = 1; step < 32; step *= 2) {
    unsigned int const other = __shfl_up_sync(0xffffffffu, before, step);
    if (lane >= step) before += other;
  }
  if (lane == 31) warp_sums[warp] = before;
  __syncthreads();
  before -= sum;
  for (int other = 0; other < warp; ++other) before += warp_sums[other];
  for (int i = 0; i < share; ++i) {
    unsigned int const here = cursor[threadIdx.x * share + i];
    cursor[threadIdx.x * share + i] = before;
    before += here;
  }
  __syncthreads();
  // the places of the chunk's records, in order, where the records themselves will be
  std::uint64_t const first_place = chunks.parts == 1 ? first_dot * batch.rays : first_dot * batch.rays + first_ray;
  for (int i = threadIdx.x; i < count; i += order_threads) {
    order[first_place + atomicAdd(&cursor[cell[i]], 1u)] = static_cast<std::uint32_t>(first_place) + i;
  }
}

/// The order of a batch's rays; empty where there is no memory for it, which only costs time.
template <class T>
DeviceArray<std::uint32_t> order_rays(SceneView<T> const& view, Bounds<T> const& box, Batch const& batch) {
  DeviceArray<std::uint32_t> order;
  try {
    order = DeviceArray<std::uint32_t>(batch.dots * batch.rays, "the order of a batch's rays");
  } catch (OutOfDeviceMemory const&) {
    return {};
  }
  Chunks const chunks(batch);
  auto const bytes = static_cast<unsigned>(chunks.dots * chunks.rays) * sizeof(unsigned short);
  allow_shared_bytes(order_rays_kernel<T>, Chunks::most_rays * sizeof(unsigned short));
  order_rays_kernel<T>
      <<<static_cast<unsigned>(chunks.number), order_threads, bytes>>>(view, box, batch, chunks, order.data());
  check_launch("order_rays");
  return order;
}

}  // namespace gladstone::cuda
