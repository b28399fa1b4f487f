#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/uncertainty/neighbour_mean.h"
#include "analysis/uncertainty/window_statistics.h"
#include "cuda/correlation/block_sums.cuh"
#include "cuda/correlation/correlation_statistics.h"
#include "cuda/device/cuda_error.h"
#include "cuda/device/launch.h"

namespace gladstone::cuda::inline correlation {
namespace {

constexpr int most_threads = 256;
constexpr int most_warps = most_threads / 32;
using Statistics = WindowStatistics<OneColumn>;

/// Pixels of one window; the weight is 0 where a frame is unknown (NaN) or outside the image.
struct WindowPixels {
  DevicePair pair;
  float const* weight_x;
  float const* weight_y;
  int first_x, first_y;  ///< image position of the window's first pixel

  __device__ MatchedPixels<float> at(int x, int row) const {
    int const column = first_x + x, image_row = first_y + row;
    if (column < 0 || column >= pair.columns || image_row < 0 || image_row >= pair.rows) return {0.0f, 0.0f, 0.0f};
    GreyPair const pixel = pair.pixels[static_cast<long long>(image_row) * pair.columns + column];
    if (isnan(pixel.reference + pixel.flow)) return {0.0f, 0.0f, 0.0f};
    return {weight_x[x] * weight_y[row], pixel.reference, pixel.flow};
  }
};

/// Computes the variances of the windows, one window per block at a time.
/// @tparam in_shared  whether the block's memory is shared memory; otherwise it is in `scratch`
template <bool in_shared>
__global__ void __launch_bounds__(most_threads)
    find_variances(MatchedWindows const __grid_constant__ windows, float* scratch, Vec2d* variances) {
  extern __shared__ __align__(16) float shared[];
  __shared__ double light_slots[3 * most_warps];
  __shared__ double square_slots[2 * most_warps];
  __shared__ double sum_slots[StatisticsSums::count * most_warps];
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  int const side = windows.side, thread = static_cast<int>(threadIdx.x);
  float* memory = shared;
  if constexpr (!in_shared) memory = scratch + static_cast<std::size_t>(blockIdx.x) * Statistics::values(side);
  Statistics const own{memory, side, thread, static_cast<int>(blockDim.x)};
  auto const count = static_cast<unsigned>(windows.grid.size());
  for (unsigned window = blockIdx.x; window < count; window += gridDim.x) {
    if (windows.vectors[window].status != VectorStatus::valid) {
      if (thread == 0) variances[window] = {nan, nan};
      continue;
    }
    int const column = static_cast<int>(window) % windows.grid.columns,
              row = static_cast<int>(window) / windows.grid.columns;
    WindowPixels const pixels{windows.pair, windows.x.weight(column) + windows.margin,
                              windows.y.weight(row) + windows.margin, windows.x.first(column) + windows.margin,
                              windows.y.first(row) + windows.margin};
    own.clear();
    WindowSums<double> const share = own.sum_pixels(pixels);
    double light[3] = {share.weight, share.reference, share.flow};
    block_sums(light, light_slots);
    WindowLevels const means = weighted_means({light[0], light[1], light[2]});
    Vec2d const squares_share = own.sum_squares(pixels, means);
    double squares[2] = {squares_share.x, squares_share.y};
    block_sums(squares, square_slots);
    WindowLevels const levels = equally_bright(means, {squares[0], squares[1]});
    StatisticsSums sums;
    for (int n = 0; n < Statistics::steps(side); ++n) {
      own.step(n, pixels, levels, sums);
      __syncthreads();
    }
    double all[StatisticsSums::count];
    int k = 0;
    sums.each([&](double const& sum) { all[k++] = sum; });
    block_sums(all, sum_slots);
    if (thread != 0) continue;
    k = 0;
    sums.each([&](double& sum) { sum = all[k++]; });
    double const squared = windows.amplification * windows.amplification;
    variances[window] = {squared * displacement_variance(sums, 0), squared * displacement_variance(sums, 1)};
  }
}

__global__ void average_variances(Vec2d const* variances, int columns, int rows, Vec2d* sigma) {
  int const i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= columns * rows) return;
  int const column = i % columns, row = i / columns;
  auto const at = [&](int x, int y) { return variances[static_cast<long long>(y) * columns + x]; };
  double const along_x = mean_of_neighbours(column, row, columns, rows, [&](int x, int y) { return at(x, y).x; });
  double const along_y = mean_of_neighbours(column, row, columns, rows, [&](int x, int y) { return at(x, y).y; });
  sigma[i] = {sqrt(along_x), sqrt(along_y)};
}

std::size_t bytes_of(int side) { return statistics_values(side) * sizeof(float); }

}  // namespace

std::size_t statistics_values(int side) { return static_cast<std::size_t>(Statistics::values(side)); }

bool statistics_need_scratch(int side) { return bytes_of(side) > most_shared_bytes(find_variances<true>); }

void estimate_sigma(MatchedWindows const& windows, float* scratch, int slots, Vec2d* variances, Vec2d* sigma) {
  int const threads = std::min(most_threads, (windows.side + 31) / 32 * 32);
  auto const count = static_cast<unsigned>(windows.grid.size());
  if (scratch == nullptr) {
    allow_shared_bytes(find_variances<true>, bytes_of(windows.side));
    find_variances<true><<<count, threads, bytes_of(windows.side)>>>(windows, nullptr, variances);
  } else {
    find_variances<false><<<std::min(count, static_cast<unsigned>(slots)), threads>>>(windows, scratch, variances);
  }
  check_launch("find_variances");
  constexpr unsigned threads_of_mean = 128;
  average_variances<<<(count + threads_of_mean - 1) / threads_of_mean, threads_of_mean>>>(
      variances, windows.grid.columns, windows.grid.rows, sigma);
  check_launch("average_variances");
}

}  // namespace gladstone::cuda::inline correlation
