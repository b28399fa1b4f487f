#include "analysis/correlation/window_deformation.h"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/device/cuda_error.h"

namespace gladstone::cuda::inline correlation {
namespace {

constexpr int threads = 256;
constexpr int threads_of_rounds = 512;  // threads per block of the single-block kernel

/// Returns 1 if both images of the original pair are known at a pixel, otherwise 0.
struct KnownPixels {
  DevicePair pair;
  __device__ float operator()(int column, int row) const {
    GreyPair const pixel = pair.pixels[static_cast<long long>(row) * pair.columns + column];
    return isnan(pixel.reference) || isnan(pixel.flow) ? 0.0f : 1.0f;
  }
};

template <int degree>
__global__ void deform_pixels(BsplineView<float> reference, BsplineView<float> flow, KnownPixels known,
                              PredictorView predictor, DevicePair deformed) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  int const j = static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y);
  if (i >= deformed.columns || j >= deformed.rows) return;
  Vec2d const d = predictor.at({static_cast<double>(i), static_cast<double>(j)});
  DeformedPixel const pixel =
      deformed_pixel<degree>(reference, flow, i, j, static_cast<float>(d.x), static_cast<float>(d.y), known);
  float const unknown = nanf("");
  deformed.pixels[static_cast<long long>(j) * deformed.columns + i] =
      pixel.available > 0.0f ? GreyPair{pixel.reference, pixel.flow} : GreyPair{unknown, unknown};
}

/// Returns node k of smoothed_displacement().
__device__ Vec2d smoothed_node(Vec2d const* nodes, int k, int columns, int rows, double part) {
  int const column = k % columns, row = k / columns;
  auto const across = [&](int at) {
    return column > 0 && column + 1 < columns ? smoothed(nodes[at - 1], nodes[at], nodes[at + 1], part) : nodes[at];
  };
  return row > 0 && row + 1 < rows ? smoothed(across(k - columns), across(k), across(k + columns), part) : across(k);
}

/// Smooths nodes and extrapolates them beyond the grid.
__global__ void extend_nodes(InterrogationGrid grid, Vec2d const* nodes, double part, PredictorView predictor,
                             Vec2d* extended) {
  int const k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k >= predictor.columns * predictor.rows) return;
  extended[k] = extended_node(
      grid, [&](int node) { return smoothed_node(nodes, node, grid.columns, grid.rows, part); },
      k % predictor.columns - predictor.ghosts, k / predictor.columns - predictor.ghosts);
}

/// Copies the displacements of valid vectors and lists the others.
__global__ void gather_nodes(GridVector const* vectors, int size, Vec2d* nodes, char* known, Replacement* list,
                             int* count) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= size) return;
  bool const sound = is_valid_or_replaced(vectors[i].status);
  nodes[i] = sound ? vectors[i].displacement : Vec2d{};
  known[i] = sound;
  if (!sound) list[atomicAdd(count, 1)] = {i, FailedTest::none, Replacement::open, {}};
}

/// Fills the listed nodes from the edge of each gap inwards; within a round, only nodes known before it are used.
/// Single block.
__global__ void __launch_bounds__(threads_of_rounds)
    fill_nodes(Vec2d* nodes, char* known, int columns, int rows, Replacement* list, int const* count) {
  int progress = *count > 0;
  while (progress) {
    progress = 0;
    for (int n = static_cast<int>(threadIdx.x); n < *count; n += static_cast<int>(blockDim.x)) {
      Replacement& hole = list[n];
      if (hole.state == Replacement::open &&
          find_gap_value(
              nodes, hole.index, columns, rows, [&](int k) { return known[k] != 0; }, hole.by.value))
        hole.state = Replacement::found;
    }
    __syncthreads();
    for (int n = static_cast<int>(threadIdx.x); n < *count; n += static_cast<int>(blockDim.x)) {
      Replacement& hole = list[n];
      if (hole.state != Replacement::found) continue;
      nodes[hole.index] = hole.by.value;
      known[hole.index] = 1;
      hole.state = Replacement::done;
      progress = 1;
    }
    progress = __syncthreads_or(progress);
  }
}

unsigned blocks(int count) { return static_cast<unsigned>((count + threads - 1) / threads); }

}  // namespace

void make_predictor(GridVector const* vectors, Vec2d* nodes, char* known, Replacement* list, int* count,
                    double smoothing, PredictorView const& predictor, Vec2d* extended) {
  InterrogationGrid const& grid = predictor.grid;
  int const size = static_cast<int>(grid.size());
  check(cudaMemsetAsync(count, 0, sizeof(int)), "cudaMemsetAsync");
  gather_nodes<<<blocks(size), threads>>>(vectors, size, nodes, known, list, count);
  check_launch("gather_nodes");
  fill_nodes<<<1, threads_of_rounds>>>(nodes, known, grid.columns, grid.rows, list, count);
  check_launch("fill_nodes");
  extend_predictor(nodes, smoothing, predictor, extended);
}

void extend_predictor(Vec2d const* nodes, double smoothing, PredictorView const& predictor, Vec2d* extended) {
  extend_nodes<<<blocks(predictor.columns * predictor.rows), threads>>>(predictor.grid, nodes, smoothing, predictor,
                                                                        extended);
  check_launch("extend_nodes");
}

void deform_pair(BsplineView<float> const& reference, BsplineView<float> const& flow, int degree,
                 DevicePair const& original, PredictorView const& predictor, DevicePair const& deformed) {
  dim3 const block(32, 8);
  dim3 const grid(static_cast<unsigned>(deformed.columns + 31) / 32, static_cast<unsigned>(deformed.rows + 7) / 8);
  KnownPixels const known{original};
  if (degree == 3)
    deform_pixels<3><<<grid, block>>>(reference, flow, known, predictor, deformed);
  else
    deform_pixels<5><<<grid, block>>>(reference, flow, known, predictor, deformed);
  check_launch("deform_pixels");
}

}  // namespace gladstone::cuda::inline correlation
