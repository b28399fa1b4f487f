#include <algorithm>
#include <cmath>

#include "cuda/correlation/correlation_kernels.h"
#include "cuda/device/cuda_error.h"
#include "cuda/device/ordered_key.cuh"

namespace gladstone::cuda {
namespace {

constexpr int threads = 256;

__device__ bool finite(double value) { return fabs(value) <= 1.7976931348623157e308; }

__global__ void find_levels(double const* reference, double const* flow, long long count, LevelKeys* keys) {
  unsigned long long highest = 0, minus_lowest = 0;
  long long const stride = static_cast<long long>(gridDim.x) * blockDim.x;
  for (long long i = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x; i < 2 * count; i += stride) {
    double const value = i < count ? reference[i] : flow[i - count];
    if (!finite(value)) continue;
    highest = max(highest, ordered_key(value));
    minus_lowest = max(minus_lowest, ordered_key(-value));
  }
  for (int offset = 16; offset > 0; offset /= 2) {
    highest = max(highest, __shfl_xor_sync(0xffffffffu, highest, offset));
    minus_lowest = max(minus_lowest, __shfl_xor_sync(0xffffffffu, minus_lowest, offset));
  }
  if (threadIdx.x % 32 == 0) {
    atomicMax(&keys->highest, highest);
    atomicMax(&keys->minus_lowest, minus_lowest);
  }
}

__global__ void remove_level(double const* reference, double const* flow, long long count, LevelKeys const* keys,
                             float* contrast, GreyPair* pixels) {
  // the level between the extremes, taken off in double, keeps faint contrast on a bright ground in float
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

/// Pixel k of a line, 0 where an image is not known.
__device__ GreyPair sample_of(GreyPair const* line, int step, int k) {
  GreyPair const value = line[static_cast<long long>(k) * step];
  return {isnan(value.reference) ? 0.0f : value.reference, isnan(value.flow) ? 0.0f : value.flow};
}

/// Coefficients i of a line of both images, reflected at its ends.
__device__ GreyPair filtered(GreyPair const* line, int step, int count, int i, float const* taps, int tap_count) {
  GreyPair const middle = sample_of(line, step, i);
  GreyPair sum{taps[0] * middle.reference, taps[0] * middle.flow};
  auto const add = [&](float tap, GreyPair before, GreyPair behind) {
    sum = {sum.reference + tap * (before.reference + behind.reference), sum.flow + tap * (before.flow + behind.flow)};
  };
  if (i >= tap_count && i + tap_count < count)
    for (int k = 1; k < tap_count; ++k) add(taps[k], sample_of(line, step, i - k), sample_of(line, step, i + k));
  else
    for (int k = 1; k < tap_count; ++k)
      add(taps[k], sample_of(line, step, mirrored_index(i - k, count)),
          sample_of(line, step, mirrored_index(i + k, count)));
  return sum;
}

__global__ void filter_rows(DevicePair pair, float const* taps, int tap_count, GreyPair* out) {
  long long const at = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (at >= static_cast<long long>(pair.columns) * pair.rows) return;
  int const column = static_cast<int>(at % pair.columns);
  out[at] = filtered(pair.pixels + (at - column), 1, pair.columns, column, taps, tap_count);
}

/// Filters the columns and lays the margin round the coefficients.
__global__ void filter_columns(GreyPair const* image, int columns, int rows, float const* taps, int tap_count,
                               float* reference, float* flow) {
  using View = BsplineView<float>;
  int const stride = columns + View::margin_before + View::margin_after;
  long long const at = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (at >= static_cast<long long>(stride) * (rows + View::margin_before + View::margin_after)) return;
  int const column = mirrored_index(static_cast<int>(at % stride) - View::margin_before, columns);
  int const row = mirrored_index(static_cast<int>(at / stride) - View::margin_before, rows);
  GreyPair const coefficient = filtered(image + column, columns, rows, row, taps, tap_count);
  reference[at] = coefficient.reference;
  flow[at] = coefficient.flow;
}

unsigned blocks(long long count) { return static_cast<unsigned>((count + threads - 1) / threads); }

}  // namespace

void prepare_pair(DeviceImage const& reference, DeviceImage const& flow, LevelKeys* keys, float* contrast,
                  DevicePair const& pair) {
  constexpr unsigned most_blocks = 1024;
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
  filter_rows<<<blocks(static_cast<long long>(columns) * rows), threads>>>(pair, taps, tap_count, scratch);
  check_launch("filter_rows");
  filter_columns<<<blocks(static_cast<long long>(columns + margin) * (rows + margin)), threads>>>(
      scratch, columns, rows, taps, tap_count, coefficients[0], coefficients[1]);
  check_launch("filter_columns");
  for (int k = 0; k < 2; ++k) spline[k] = {coefficients[k], columns + margin, columns, rows};
}

}  // namespace gladstone::cuda
