#include "analysis/correlation/steep_refinement.h"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/device/cuda_error.h"

namespace gladstone::cuda::inline correlation {
namespace {

constexpr int threads = 128;
constexpr int threads_of_rounds = 512;  // threads per block of the single-block kernels

__global__ void make_vectors(WindowCorrelation const* windows, InterrogationGrid grid, PassPredictor predictor,
                             double limit_px, AmbiguousPlaces before, GridVector* vectors, char* ambiguous) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= static_cast<int>(grid.size())) return;
  Vec2d const centre = grid.centre(static_cast<std::size_t>(i));
  GridVector const vector = grid_vector(windows[i], predictor.at(centre), limit_px, before.at(centre));
  vectors[i] = vector;
  ambiguous[i] = vector.ambiguous != Ambiguity::none;
}

__global__ void find_spurious(GridVector const* vectors, int columns, int rows, ValidationRule rule, ValidationStage by,
                              Replacement* list, int* count) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= columns * rows) return;
  FailedTest const failed = failed_test(vectors, i, columns, rows, rule, by);
  if (failed != FailedTest::none) list[atomicAdd(count, 1)] = {i, failed, Replacement::open, {}};
}

/// Replaces spurious vectors in rounds, from the edge of a cluster of them inwards; within a round, only vectors that
/// were valid before it are used, so that the order of the list does not matter. Single block.
__global__ void __launch_bounds__(threads_of_rounds)
    replace_spurious(GridVector* vectors, int columns, int rows, ValidationRule rule, Replacement* list,
                     int const* count) {
  int const first = static_cast<int>(threadIdx.x), step = static_cast<int>(blockDim.x);
  for (int n = first; n < *count; n += step) reject_vector(vectors[list[n].index], list[n].failed);
  int progress = __syncthreads_or(rule.replaces && *count > 0);
  while (progress) {
    progress = 0;
    for (int n = first; n < *count; n += step) {
      Replacement& spurious = list[n];
      if (spurious.state == Replacement::open &&
          find_replacement(vectors, spurious.index, columns, rows, rule, spurious.by))
        spurious.state = Replacement::found;
    }
    __syncthreads();
    for (int n = first; n < *count; n += step) {
      Replacement& spurious = list[n];
      if (spurious.state != Replacement::found) continue;
      replace(vectors[spurious.index], spurious.by, rule);
      spurious.state = Replacement::done;
      progress = 1;
    }
    progress = __syncthreads_or(progress);
  }
}

__global__ void count_steep_vectors(GridVector const* vectors, InterrogationGrid grid, int* count) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  int const steep = __syncthreads_count(i < static_cast<int>(grid.size()) && is_steep(vectors, i, grid));
  if (threadIdx.x == 0 && steep > 0) atomicAdd(count, steep);
}

__global__ void take_measured(WindowCorrelation const* windows, GridVector const* vectors, int size,
                              MeasuredVector* measured) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < size) measured[i] = measured_vector(vectors[i], windows[i]);
}

unsigned blocks(InterrogationGrid const& grid) { return static_cast<unsigned>((grid.size() + threads - 1) / threads); }

}  // namespace

void take_vectors(WindowCorrelation const* windows, GridVector* vectors, InterrogationGrid const& grid,
                  PassPredictor const& predictor, double limit_px, AmbiguousPlaces const& before, char* ambiguous) {
  make_vectors<<<blocks(grid), threads>>>(windows, grid, predictor, limit_px, before, vectors, ambiguous);
  check_launch("make_vectors");
}

void validate(GridVector* vectors, InterrogationGrid const& grid, ValidationRule const& rule, Replacement* list,
              int* count) {
  for (int by = 0; by < validation_stage_count(rule); ++by) {
    check(cudaMemsetAsync(count, 0, sizeof(int)), "cudaMemsetAsync");
    find_spurious<<<blocks(grid), threads>>>(vectors, grid.columns, grid.rows, rule, static_cast<ValidationStage>(by),
                                             list, count);
    check_launch("find_spurious");
    replace_spurious<<<1, threads_of_rounds>>>(vectors, grid.columns, grid.rows, rule, list, count);
    check_launch("replace_spurious");
  }
}

void count_steep(GridVector const* vectors, InterrogationGrid const& grid, int* count) {
  check(cudaMemsetAsync(count, 0, sizeof(int)), "cudaMemsetAsync");
  count_steep_vectors<<<blocks(grid), threads>>>(vectors, grid, count);
  check_launch("count_steep_vectors");
}

void finish(WindowCorrelation const* windows, GridVector const* vectors, InterrogationGrid const& grid,
            MeasuredVector* measured) {
  take_measured<<<blocks(grid), threads>>>(windows, vectors, static_cast<int>(grid.size()), measured);
  check_launch("take_measured");
}

}  // namespace gladstone::cuda::inline correlation
