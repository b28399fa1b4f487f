#include <algorithm>
#include <cmath>

#include "cuda/correlation/correlation_kernels.h"
#include "cuda/device/cuda_error.h"
#include "cuda/device/ordered_key.cuh"
#include "render/base/contracts.h"

namespace gladstone::cuda::inline correlation {
namespace {

constexpr int threads = 256;

__device__ bool finite(double value) { return fabs(value) <= 1.7976931348623157e308; }

__device__ unsigned long long highest_of_warp(unsigned long long key) {
  for (int offset = 16; offset > 0; offset /= 2) key = max(key, __shfl_xor_sync(0xffffffffu, key, offset));
  return key;
}

__global__ void find_levels(double const* reference, double const* flow, long long count, LevelKeys* keys) {
  unsigned long long highest = 0, minus_lowest = 0;
  long long const stride = static_cast<long long>(gridDim.x) * blockDim.x;
  for (long long i = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x; i < 2 * count; i += stride) {
    double const value = i < count ? reference[i] : flow[i - count];
    if (!finite(value)) continue;
    highest = max(highest, ordered_key(value));
    minus_lowest = max(minus_lowest, ordered_key(-value));
  }
  highest = highest_of_warp(highest);
  minus_lowest = highest_of_warp(minus_lowest);
  // One atomic operation per block and value, since all blocks compete for the same two addresses.
  __shared__ unsigned long long of_warps[2][threads / 32];
  unsigned const lane = threadIdx.x % 32;
  if (lane == 0) {
    of_warps[0][threadIdx.x / 32] = highest;
    of_warps[1][threadIdx.x / 32] = minus_lowest;
  }
  __syncthreads();
  if (threadIdx.x >= 32) return;
  highest = highest_of_warp(lane < threads / 32 ? of_warps[0][lane] : 0);
  minus_lowest = highest_of_warp(lane < threads / 32 ? of_warps[1][lane] : 0);
  if (lane == 0) {
    atomicMax(&keys->highest, highest);
    atomicMax(&keys->minus_lowest, minus_lowest);
  }
}

__global__ void remove_level(double const* reference, double const* flow, long long count, LevelKeys const* keys,
                             float* contrast, GreyPair* pixels) {
  // Subtracting a mid-range level in double preserves faint contrast on a bright background in float.
  double const highest = key_value(keys->highest), lowest = -key_value(keys->minus_lowest);
  bool const any = keys->highest != 0;
  double const level = any ? 0.5 * (lowest + highest) : 0.0, range = any ? highest - lowest : 0.0;
  double const scale = range > 0.0 ? ldexp(1.0, -ilogb(range)) : 1.0;
  long long const i = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0) *contrast = static_cast<float>(range * scale);
  if (i >= count) return;
  float const unknown = nanf("");
  pixels[i] = {finite(reference[i]) ? static_cast<float>((reference[i] - level) * scale) : unknown,
               finite(flow[i]) ? static_cast<float>((flow[i] - level) * scale) : unknown};
}

/// Computes `run` adjacent coefficients of a line from samples read by one thread; each sample contributes to all of
/// them.
/// @param sample  sample(i) relative to the first coefficient, -reach <= i < reach + run
template <int run, class Sample>
__device__ void filter_run(Sample const& sample, float const* taps, int reach, GreyPair (&sum)[run]) {
  float tap[run] = {};
#pragma unroll
  for (GreyPair& value : sum) value = {0.0f, 0.0f};
#pragma unroll 4
  for (int i = -reach; i < reach + run; ++i) {
#pragma unroll
    for (int r = run - 1; r > 0; --r)
      tap[r] = tap[r - 1];  // each coefficient uses the tap that the previous one used for the sample before
    tap[0] = i <= reach ? taps[abs(i)] : 0.0f;
    GreyPair const value = sample(i);
#pragma unroll
    for (int r = 0; r < run; ++r)
      sum[r] = {sum[r].reference + tap[r] * value.reference, sum[r].flow + tap[r] * value.flow};
  }
}

constexpr int most_taps = 48;  // maximum number of taps of bspline_taps()

__device__ void share_taps(float const* taps, int count, float (&shared)[most_taps]) {
  unsigned const thread = threadIdx.y * blockDim.x + threadIdx.x;
  if (thread < static_cast<unsigned>(count)) shared[thread] = taps[thread];
}

constexpr int row_run = 4;
constexpr int row_part = threads * row_run;  // number of pixels of a row that a block filters

/// Filters rows, continued by reflection at their ends. Unknown pixels count as 0.
__global__ void __launch_bounds__(threads)
    filter_rows(DevicePair pair, float const* taps, int tap_count, GreyPair* out) {
  // Skip every seventeenth position: samples four apart are then in different banks.
  constexpr int most = row_part + 2 * most_taps;
  __shared__ GreyPair samples[most + most / 16];
  __shared__ float shared_taps[most_taps];
  auto const place = [](int k) { return k + k / 16; };
  int const reach = tap_count - 1, first = static_cast<int>(blockIdx.y) * row_part;
  GreyPair const* const line = pair.pixels + static_cast<long long>(blockIdx.x) * pair.columns;
  share_taps(taps, tap_count, shared_taps);
  for (int k = static_cast<int>(threadIdx.x); k < row_part + 2 * reach; k += threads) {
    GreyPair const value = line[mirrored_index(first + k - reach, pair.columns)];
    samples[place(k)] = {isnan(value.reference) ? 0.0f : value.reference, isnan(value.flow) ? 0.0f : value.flow};
  }
  __syncthreads();
  int const own = static_cast<int>(threadIdx.x) * row_run;
  if (first + own >= pair.columns) return;
  GreyPair sum[row_run];
  filter_run([&](int i) { return samples[place(own + reach + i)]; }, shared_taps, reach, sum);
  for (int r = 0; r < row_run; ++r)
    if (first + own + r < pair.columns)
      out[static_cast<long long>(blockIdx.x) * pair.columns + first + own + r] = sum[r];
}

constexpr int column_run = 8;
constexpr dim3 column_block(32, 4);

/// Filters the columns and fills the margin around the coefficients.
__global__ void filter_columns(GreyPair const* image, int columns, int rows, float const* taps, int tap_count,
                               float* reference, float* flow) {
  using View = BsplineView<float>;
  __shared__ float shared_taps[most_taps];
  share_taps(taps, tap_count, shared_taps);
  __syncthreads();
  int const stride = columns + View::margin_before + View::margin_after;
  int const lines = rows + View::margin_before + View::margin_after;
  int const at = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  int const first = static_cast<int>(blockIdx.y * blockDim.y + threadIdx.y) * column_run;
  if (at >= stride || first >= lines) return;
  GreyPair const* const column = image + mirrored_index(at - View::margin_before, columns);
  GreyPair sum[column_run];
  filter_run(
      [&](int i) {
        return column[static_cast<long long>(mirrored_index(first + i - View::margin_before, rows)) * columns];
      },
      shared_taps, tap_count - 1, sum);
  for (int r = 0; r < column_run && first + r < lines; ++r) {
    long long const to = static_cast<long long>(first + r) * stride + at;
    reference[to] = sum[r].reference;
    flow[to] = sum[r].flow;
  }
}

unsigned blocks(long long count) { return static_cast<unsigned>((count + threads - 1) / threads); }

}  // namespace

void prepare_pair(DeviceImage const& reference, DeviceImage const& flow, LevelKeys* keys, float* contrast,
                  DevicePair const& pair) {
  constexpr unsigned most_blocks = 528;
  long long const count = static_cast<long long>(pair.columns) * pair.rows;
  check(cudaMemsetAsync(keys, 0, sizeof(LevelKeys)), "cudaMemsetAsync");
  unsigned const enough = std::min(blocks(2 * count), most_blocks);
  find_levels<<<enough, threads>>>(reference.pixels, flow.pixels, count, keys);
  check_launch("find_levels");
  remove_level<<<blocks(count), threads>>>(reference.pixels, flow.pixels, count, keys, contrast, pair.pixels);
  check_launch("remove_level");
}

void filter_pair(DevicePair const& pair, float const* taps, int tap_count, GreyPair* scratch,
                 float* const (&coefficients)[2], BsplineView<float> (&spline)[2]) {
  using View = BsplineView<float>;
  constexpr int margin = View::margin_before + View::margin_after;
  int const columns = pair.columns, rows = pair.rows;
  GLADSTONE_EXPECTS(tap_count <= most_taps);
  auto const shares = [](int count, int of) { return static_cast<unsigned>((count + of - 1) / of); };
  filter_rows<<<dim3(static_cast<unsigned>(rows), shares(columns, row_part)), threads>>>(pair, taps, tap_count,
                                                                                         scratch);
  check_launch("filter_rows");
  dim3 const tiles(shares(columns + margin, static_cast<int>(column_block.x)),
                   shares(rows + margin, static_cast<int>(column_block.y) * column_run));
  filter_columns<<<tiles, column_block>>>(scratch, columns, rows, taps, tap_count, coefficients[0], coefficients[1]);
  check_launch("filter_columns");
  for (int k = 0; k < 2; ++k) spline[k] = {coefficients[k], columns + margin, columns, rows};
}

}  // namespace gladstone::cuda::inline correlation
