#pragma once

#include <cmath>

#include "analysis/tomography/line_samples.h"
#include "analysis/tomography/sart_volume.h"
#include "analysis/tomography/total_variation_stencil.h"
#include "cuda/device/block_sum.cuh"

/// Kernels of SART. Sums over a block are stored for each block, and added by the host in the order of the blocks.
namespace gladstone::cuda::inline tomography {

inline constexpr int line_threads = 128;
inline constexpr int node_threads = 256;
inline constexpr int tile_x = 8, tile_y = 8, tile_z = 4;  ///< nodes of a block of the back projection
static_assert(tile_x * tile_y * tile_z == node_threads);

/// Sums of the squares of residuals and values.
struct LineSums {
  double residual, value;
  __device__ LineSums& operator+=(LineSums const& other) {
    residual += other.residual;
    value += other.value;
    return *this;
  }
};

/// Sum of the squared changes of nodes, and the largest absolute value of a node.
struct ChangeSums {
  double change, largest;
  __device__ ChangeSums& operator+=(ChangeSums const& other) {
    change += other.change;
    largest = fmax(largest, other.largest);
    return *this;
  }
};

/// Sums of the squared changes and the squared values of nodes.
struct NormSums {
  double change, volume;
  __device__ NormSums& operator+=(NormSums const& other) {
    change += other.change;
    volume += other.volume;
    return *this;
  }
};

/// View in device memory.
struct DeviceView {
  int count;
  SightLine const* lines;
  LineSamples const* samples;
  double const* value;     ///< line integral of each line; NaN: the line is ignored
  double const* row_sums;  ///< row sum of the matrix for each line [m]
};

__global__ void sample_lines(VolumeShape shape, SightLine const* lines, int count, LineSamples* samples) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) samples[i] = LineSamples::of(shape, lines[i]);
}

/// Projects the volume along the lines of a view. @param quotients  output: LineResidual::quotient [lines]
__global__ void __launch_bounds__(line_threads)
    project_lines(LineProjection integrate, DeviceView view, double* quotients, LineSums* sums) {
  __shared__ LineSums shared[line_threads];
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  LineSums own{0.0, 0.0};
  if (i < view.count) {
    auto const line = LineResidual::of(view.value[i], integrate(view.lines[i]), view.row_sums[i]);
    quotients[i] = line.quotient;
    if (isfinite(view.value[i])) own = {line.difference * line.difference, view.value[i] * view.value[i]};
  }
  LineSums const all = block_sum(own, shared);
  if (threadIdx.x == 0) sums[blockIdx.x] = all;
}

/// Corrects the nodes of a tile by one view: a thread gathers the contributions to its node in the order of the lines.
__global__ void __launch_bounds__(node_threads)
    correct_nodes(VolumeShape shape, DeviceView view, double const* quotients, double relaxation, bool count_views,
                  double* volume, long long* views) {
  constexpr int warps = node_threads / 32;
  __shared__ int chosen[node_threads], counts[warps];
  int const thread = static_cast<int>(threadIdx.x), warp = thread / 32, lane = thread % 32;
  int const tile[3] = {tile_x, tile_y, tile_z};
  int const low[3] = {static_cast<int>(blockIdx.x) * tile_x, static_cast<int>(blockIdx.y) * tile_y,
                      static_cast<int>(blockIdx.z) * tile_z};
  int const node[3] = {low[0] + thread % tile_x, low[1] + thread / tile_x % tile_y,
                       low[2] + thread / (tile_x * tile_y)};
  NodeSum sum;
  for (int first = 0; first < view.count; first += node_threads) {
    // Choose the lines of this chunk that meet the tile, in their order
    int const candidate = first + thread;
    bool meets = candidate < view.count && isfinite(quotients[candidate]);
    if (meets) {
      LineSamples const& samples = view.samples[candidate];
      int begin = 0, end = samples.count;
      for (int axis = 0; axis < 3; ++axis)
        limit_samples(samples, axis, low[axis] - 1.0, low[axis] + tile[axis], begin, end);
      meets = begin < end;
    }
    unsigned const votes = __ballot_sync(0xffffffffu, meets);
    if (lane == 0) counts[warp] = __popc(votes);
    __syncthreads();
    int before = 0, found = 0;
    for (int w = 0; w < warps; ++w) {
      if (w < warp) before += counts[w];
      found += counts[w];
    }
    if (meets) chosen[before + __popc(votes & ((1u << lane) - 1u))] = candidate;
    __syncthreads();
    for (int n = 0; n < found; ++n) {
      int const line = chosen[n];
      double const quotient = quotients[line];
      visit_node(shape, view.lines[line], view.samples[line], node, [&](double weight) { sum.add(weight, quotient); });
    }
    __syncthreads();
  }
  if (node[0] >= shape.nodes[0] || node[1] >= shape.nodes[1] || node[2] >= shape.nodes[2]) return;
  if (!(sum.weight > 0.0)) return;
  long long const index = node[0] + shape.nodes[0] * (node[1] + static_cast<long long>(shape.nodes[1]) * node[2]);
  volume[index] = correct_node(volume[index], sum, relaxation);
  if (count_views) ++views[index];
}

__global__ void __launch_bounds__(node_threads) sum_changes(double const* volume, double const* before, long long count,
                                                            NodeConstraint constraint, ChangeSums* sums) {
  __shared__ ChangeSums shared[node_threads];
  ChangeSums own{0.0, 0.0};
  for (long long i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += gridDim.x * blockDim.x) {
    double const change = constraint.is_free(static_cast<std::size_t>(i)) ? volume[i] - before[i] : 0.0;
    own += {change * change, fabs(volume[i])};
  }
  ChangeSums const all = block_sum(own, shared);
  if (threadIdx.x == 0) sums[blockIdx.x] = all;
}

/// Position of a node in the volume.
struct NodePlace {
  int i, j, k;
  __device__ NodePlace(TotalVariationStencil const& stencil, long long node)
      : i(static_cast<int>(node % stencil.nodes[0])),
        j(static_cast<int>(node / stencil.nodes[0] % stencil.nodes[1])),
        k(static_cast<int>(node / stencil.nodes[0] / stencil.nodes[1])) {}
};

__global__ void denoise_nodes(TotalVariationStencil stencil, double const* volume, Vec3d const* dual, double lambda,
                              long long count, double* denoised) {
  long long const node = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (node >= count) return;
  NodePlace const at(stencil, node);
  denoised[node] = stencil.denoise(volume, dual, lambda, at.i, at.j, at.k);
}

__global__ void project_dual(TotalVariationStencil stencil, double const* denoised, double lambda, long long count,
                             Vec3d* dual) {
  long long const node = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (node >= count) return;
  NodePlace const at(stencil, node);
  dual[node] = stencil.project(denoised, dual, lambda, at.i, at.j, at.k);
}

/// Applies bounds and support to `denoised`, and stores the result in `volume` and `before`.
__global__ void __launch_bounds__(node_threads)
    constrain_nodes(double const* denoised, NodeConstraint constraint, long long count, double* volume, double* before,
                    NormSums* sums) {
  __shared__ NormSums shared[node_threads];
  NormSums own{0.0, 0.0};
  for (long long i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += gridDim.x * blockDim.x) {
    double const value = constraint(denoised[i], static_cast<std::size_t>(i)), change = value - before[i];
    own += {change * change, value * value};
    volume[i] = before[i] = value;
  }
  NormSums const all = block_sum(own, shared);
  if (threadIdx.x == 0) sums[blockIdx.x] = all;
}

}  // namespace gladstone::cuda::inline tomography
