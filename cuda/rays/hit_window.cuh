#pragma once

#include "cuda/device/device_images.cuh"
#include "cuda/rays/trace_sources.h"

/// Shared memory of a block of threads that traces sources.
namespace gladstone::cuda::inline rays {

inline constexpr int source_threads = 128;

/// Threads of a block, as required by hit_spline.h.
struct Block {
  __device__ int rank() const { return static_cast<int>(threadIdx.x); }
  __device__ int size() const { return source_threads; }
  __device__ void sync() const { __syncthreads(); }
};

/// Square region of a frame in which a block accumulates the light of a source at spline nodes. The values are
/// integers, so that the order of summation does not matter; their unit is so small that rounding the shares of all
/// rays changes a pixel by less than 1e-6 of the source's light.
struct HitWindow {
  int* nodes = nullptr;  ///< light at the nodes: [side][side]; null: accepts no light
  int side, per_px;
  int left, top;  ///< pixel of node (0, 0)
  double units;   ///< integer units per unit of ray weight
  double most_weight;

  /// Returns the number of integer units per unit of weight, for a number of rays whose weights are at most
  /// most_weight. A node gets at most 4/9 of a ray, so that a sum uses less than half of the integer's range.
  __device__ static double units_per_weight(double most_weight, std::uint64_t rays) {
    return most_weight > 0 ? 0x1p31 / (most_weight * static_cast<double>(rays)) : 0;
  }

  __device__ void clear() const {
    for (int i = threadIdx.x; i < side * side; i += source_threads) nodes[i] = 0;
  }

  /// Adds a ray's light. @return false if it is outside the square, or its weight exceeds most_weight
  __device__ bool take(Vec2d p, double weight) const {
    if (!nodes || !(fabs(weight) <= most_weight)) return false;
    if (!(fabs(p.x) < 1e7 && fabs(p.y) < 1e7)) return false;
    HitStencil const x((p.x - left) * per_px), y((p.y - top) * per_px);
    if (x.first < 0 || y.first < 0 || x.first + 4 > side || y.first + 4 > side) return false;
    int* line = nodes + y.first * side + x.first;
    for (int j = 0; j < 4; ++j, line += side) {
      double const share = units * weight * y.share[j];
      for (int i = 0; i < 4; ++i) atomicAdd(line + i, __double2int_rn(share * x.share[i]));
    }
    return true;
  }

  /// Adds the accumulated light to the image.
  __device__ void flush(HitSplineView const& spline, double* rows_seen, DeviceImages const& images, int frame,
                        double sign) const {
    double const of_unit = units > 0 ? sign * images.units_per_weight / units : 0;
    blur_hits(Block(), spline, NodeRange{0, side}, NodeRange{0, side}, nodes, side, rows_seen,
              [&](int column, int row, double light) {
                if (light != 0) {
                  add_light(images, static_cast<Frame>(frame), left + column, top + row, whole_units(light * of_unit));
                }
              });
    __syncthreads();
  }
};

/// Layout of the shared memory.
/// @tparam Launch  has camera, spline, most_window_px, and windows (number per block)
struct SharedParts {
  CameraElement<double>* elements;
  RaySums* sums;      ///< sums over the rays of each thread
  double* rows_seen;  ///< buffer of blur_hits(); shares the memory of `sums`, which are no longer needed then
  double* share;      ///< weights of the spline
  int* nodes;         ///< nodes of all windows (HitWindow); null: no windows

  template <class Launch>
  __device__ SharedParts(unsigned char* memory, Launch const& launch, int threads) {
    elements = reinterpret_cast<CameraElement<double>*>(memory);
    memory += elements_bytes(launch);
    sums = reinterpret_cast<RaySums*>(memory);
    rows_seen = reinterpret_cast<double*>(memory);
    memory += common_bytes(launch, threads);
    share = reinterpret_cast<double*>(memory);
    nodes = launch.most_window_px > 0 ? reinterpret_cast<int*>(memory + share_bytes(launch)) : nullptr;
  }
  /// Copies the data common to all sources. Must be followed by a barrier.
  template <class Launch>
  __device__ void fill(Launch const& launch, int threads) const {
    auto const copy = [threads](void* to, void const* from, std::size_t bytes) {
      for (std::size_t i = threadIdx.x; i < bytes / sizeof(double); i += static_cast<std::size_t>(threads)) {
        static_cast<double*>(to)[i] = static_cast<double const*>(from)[i];
      }
    };
    copy(elements, launch.camera.elements, elements_bytes(launch));
    if (nodes) copy(share, launch.spline.share, share_bytes(launch));
  }

  template <class Launch>
  GLADSTONE_HD static std::size_t bytes(Launch const& launch, int threads) {
    auto const side = static_cast<std::size_t>(launch.most_window_px * launch.spline.per_px);
    return elements_bytes(launch) + common_bytes(launch, threads) + share_bytes(launch) +
           launch.windows * side * side * sizeof(int);
  }

 private:
  template <class Launch>
  GLADSTONE_HD static std::size_t elements_bytes(Launch const& launch) {
    static_assert(sizeof(CameraElement<double>) % 16 == 0);
    return static_cast<std::size_t>(launch.camera.count) * sizeof(CameraElement<double>);
  }
  template <class Launch>
  GLADSTONE_HD static std::size_t common_bytes(Launch const& launch, int threads) {
    std::size_t const of_sums = static_cast<std::size_t>(threads) * sizeof(RaySums);
    if (launch.most_window_px == 0) return of_sums;
    int const side = launch.most_window_px * launch.spline.per_px;
    std::size_t const of_rows =
        static_cast<std::size_t>(side) * static_cast<std::size_t>(launch.spline.pixels({0, side})) * sizeof(double);
    return of_rows > of_sums ? of_rows : of_sums;
  }
  template <class Launch>
  GLADSTONE_HD static std::size_t share_bytes(Launch const& launch) {
    return launch.most_window_px > 0 ? static_cast<std::size_t>(launch.spline.count()) * sizeof(double) : 0;
  }
};

}  // namespace gladstone::cuda::inline rays
