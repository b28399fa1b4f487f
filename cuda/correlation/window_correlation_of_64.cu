#include <algorithm>

#include "cuda/correlation/window_peaks.cuh"
#include "cuda/correlation/window_transform.h"
#include "cuda/device/launch.h"
#include "render/base/contracts.h"

/// Correlation of windows with supports of 64 px: one window per block of 256 threads, by WindowTransform, whose code
/// fits into the instruction cache. Only the peaks are written to global memory.
namespace gladstone::cuda::inline correlation {
namespace {

using Transform = WindowTransform;

constexpr unsigned all_lanes = 0xffffffffu;
constexpr int size = Transform::size;
constexpr int warps = Transform::threads / 32;
constexpr int most_width = 2 * Transform::largest_radius + 1;
constexpr int most_maxima = (most_width + 1) * (most_width + 1) / 4;  ///< maximum number of maxima, since two of them
                                                                      ///< are never adjacent
static_assert(2 * SearchBlock::most_columns > most_width && 4 * SearchBlock::most_rows >= most_width);

__device__ Transform::Roots const roots_of_64 = Transform::make_roots();

/// Shared memory of a block.
struct alignas(16) BlockMemory {
  Complex values[Transform::values];
  Transform::Roots roots;
  float sums[warps * 2];
  float known[warps * 4];
  float energy[warps * 4];
  double scale;
  HighestPeaks highest[SearchBlock::warps];
  PeakList<float> found;
};
static_assert(sizeof(PlanePeak<float>) * most_maxima <= sizeof(Complex) * Transform::upper);

/// Sums `count` (2 or 4) values over a warp, with different lanes for each value. @param slots  output: slots[k] is the
/// k-th sum
template <int count>
__device__ void warp_sums(float (&value)[count], float* slots) {
  int const lane = static_cast<int>(threadIdx.x % 32u);
  int step = 16;
#pragma unroll
  for (int left = count / 2; left > 0; left /= 2, step /= 2) {
    bool const upper = (lane & step) != 0;
#pragma unroll
    for (int k = 0; k < left; ++k) {
      float const kept = upper ? value[k + left] : value[k], sent = upper ? value[k] : value[k + left];
      value[k] = kept + __shfl_xor_sync(all_lanes, sent, step);
    }
  }
#pragma unroll
  for (; step > 0; step /= 2) value[0] += __shfl_xor_sync(all_lanes, value[0], step);
  if (lane % (32 / count) == 0) slots[lane / (32 / count)] = value[0];
}

/// Adds up the partial sums of all warps, in every thread. @param slots  partial sums, [warp][count]
template <int count>
__device__ void sum_slots(float const* slots, float (&value)[count]) {
#pragma unroll
  for (int k = 0; k < count; ++k) value[k] = slots[k];
#pragma unroll
  for (int warp = 1; warp < warps; ++warp)
#pragma unroll
    for (int k = 0; k < count; ++k) value[k] += slots[warp * count + k];
}

/// Pixels of a thread in a window and their weights along x and y: columns lane and lane + 32, rows warp + 8 r.
struct ThreadPixels {
  Complex z[2][8];
  float weight_y[8];
  float weight_x[2];

  /// Reads the pixels. Positions outside the image get the nearest pixel and weight 0.
  __device__ void read(WindowJob const& job, int column, int row, int warp, int lane) {
    int const columns = job.pair.columns, rows = job.pair.rows;
    int const first_x = job.x.first(column) + lane, first_y = job.y.first(row) + warp;
    auto const column_at = [&](int x) {
      return reinterpret_cast<unsigned char const*>(job.pair.pixels + min(max(x, 0), columns - 1));
    };
    unsigned char const *const near = column_at(first_x), *const far = column_at(first_x + 32);
    int const row_bytes = columns * static_cast<int>(sizeof(GreyPair));
#pragma unroll
    for (int r = 0; r < 8; ++r) {
      long long const line = static_cast<long long>(min(max(first_y + 8 * r, 0), rows - 1)) * row_bytes;
      GreyPair const here = *reinterpret_cast<GreyPair const*>(near + line);
      GreyPair const there = *reinterpret_cast<GreyPair const*>(far + line);
      z[0][r] = {here.reference, here.flow};
      z[1][r] = {there.reference, there.flow};
    }
    float const* const along_x = job.x.weight(column) + lane;
    float const* const along_y = job.y.weight(row) + warp;
    weight_x[0] = along_x[0];
    weight_x[1] = along_x[32];
#pragma unroll
    for (int r = 0; r < 8; ++r) weight_y[r] = along_y[8 * r];
  }

  /// Computes the weighted sums of both images.
  __device__ void sum(float (&sums)[2]) const {
    Complex column[2] = {};
#pragma unroll
    for (int half = 0; half < 2; ++half)
#pragma unroll
      for (int r = 0; r < 8; ++r) {
        column[half].re += weight_y[r] * z[half][r].re;
        column[half].im += weight_y[r] * z[half][r].im;
      }
    sums[0] = weight_x[0] * column[0].re + weight_x[1] * column[1].re;
    sums[1] = weight_x[0] * column[0].im + weight_x[1] * column[1].im;
  }

  /// Replaces unknown pixels, which are NaN in one or both images, by the mean.
  __device__ void fill_unknown(Complex mean) {
#pragma unroll
    for (auto& column : z)
#pragma unroll
      for (Complex& pixel : column)
        if (isnan(pixel.re + pixel.im)) pixel = mean;
  }

  /// Subtracts the mean and applies the weights.
  /// @param energy  output: energies of both images, in total and over the nominal window, which contains one of the
  /// two columns of each lane
  __device__ void weight(Complex mean, float (&energy)[4]) {
    int const lane = static_cast<int>(threadIdx.x % 32u);
    Complex inner[2] = {}, outer[2] = {};
#pragma unroll
    for (int half = 0; half < 2; ++half)
#pragma unroll
      for (int r = 0; r < 8; ++r) {
        float const both = weight_x[half] * weight_y[r];
        Complex& pixel = z[half][r];
        pixel = {both * (pixel.re - mean.re), both * (pixel.im - mean.im)};
        Complex& sum = r >= 2 && r < 6 ? inner[half] : outer[half];
        sum.re += pixel.re * pixel.re;
        sum.im += pixel.im * pixel.im;
      }
    Complex const core = lane < 16 ? inner[1] : inner[0];
    energy[0] = inner[0].re + inner[1].re + (outer[0].re + outer[1].re);
    energy[1] = inner[0].im + inner[1].im + (outer[0].im + outer[1].im);
    energy[2] = core.re;
    energy[3] = core.im;
  }
};

/// Computes the sums of a warp's share of the pixels known in both images: weights and weighted grey levels of both.
/// Called only for windows with unknown pixels; reads the pixels again to reduce the code size.
__device__ __noinline__ void sum_known_pixels(WindowJob const& job, int column, int row, float* slots) {
  int const lane = static_cast<int>(threadIdx.x % 32u), warp = static_cast<int>(threadIdx.x / 32u);
  float sums[4] = {0.0f, 0.0f, 0.0f, 0.0f};
#pragma unroll 1
  for (int j = warp; j < size; j += warps)
#pragma unroll 1
    for (int i = lane; i < size; i += 32) {
      int const x = min(max(job.x.first(column) + i, 0), job.pair.columns - 1);
      int const y = min(max(job.y.first(row) + j, 0), job.pair.rows - 1);
      GreyPair const grey = job.pair.pixels[static_cast<long long>(y) * job.pair.columns + x];
      if (isnan(grey.reference + grey.flow)) continue;
      float const weight = job.x.weight(column)[i] * job.y.weight(row)[j];
      sums[0] += weight;
      sums[1] += weight * grey.reference;
      sums[2] += weight * grey.flow;
    }
  warp_sums(sums, slots);
}

/// Returns plane_scale() for the sums of all warps' energies, in every lane of a warp. The factor 1/4 accounts for the
/// plane being four times the unnormalised transform.
__device__ double scale_of(float const* energy, WindowJob const& job) {
  float sum[4];
  sum_slots(energy, sum);
  return 0.25 * plane_scale({sum[0], sum[1], sum[2], sum[3]}, *job.contrast, job.grid.window_px, size);
}

__global__ void __launch_bounds__(Transform::threads, 4)
    correlate_window_of_64(WindowJob const __grid_constant__ job, int const first_row, WindowPeaks* const all_peaks) {
  extern __shared__ __align__(16) unsigned char memory[];
  BlockMemory& own = *reinterpret_cast<BlockMemory*>(memory);
  // Some steps involve only a few warps. Rotate the warp numbers by 5/4 of the block number, so that these warps are
  // distributed over the four schedulers of a multiprocessor. This also holds if a multiprocessor runs blocks whose
  // numbers differ by a multiple of four.
  unsigned const turned = (threadIdx.x + (40u * blockIdx.x & 224u)) % Transform::threads;
  int const thread = static_cast<int>(turned), lane = static_cast<int>(turned % 32u),
            warp = static_cast<int>(turned / 32u);
  int const column = static_cast<int>(blockIdx.x), row = first_row + static_cast<int>(blockIdx.y);
  WindowPeaks& result = all_peaks[static_cast<long long>(row) * job.grid.columns + column];
  Transform const transform(turned, own.values, &own.roots);
  constexpr int root_pairs = sizeof(Transform::Roots) / sizeof(Transform::ComplexPair);
  if (thread < root_pairs) own.roots.of[0][thread] = roots_of_64.of[0][thread];
  {
    ThreadPixels pixels;
    Complex mean{};
    for (bool known = false;; known = true) {  // a second run follows if some pixels are unknown
      pixels.read(job, column, row, warp, lane);
      if (known) {
        pixels.fill_unknown(mean);
        break;
      }
      float const full = static_cast<float>(job.x.sum(column) * job.y.sum(row));
      float sums[2];
      pixels.sum(sums);
      warp_sums(sums, own.sums + 2 * warp);
      __syncthreads();
      sum_slots(own.sums, sums);
      float const per_weight = 1.0f / full;
      mean = {sums[0] * per_weight, sums[1] * per_weight};
      if (!isnan(mean.re + mean.im)) break;
      sum_known_pixels(job, column, row, own.known + 4 * warp);
      __syncthreads();
      float known_sums[4];
      sum_slots(own.known, known_sums);
      if (known_sums[0] < min_valid_weight_fraction * full) {
        if (thread == 0) write_no_result(WindowCorrelation::Outcome::masked, result);
        return;
      }
      mean = {known_sums[1] / known_sums[0], known_sums[2] / known_sums[0]};
    }
    float energy[4];
    pixels.weight(mean, energy);
    warp_sums(energy, own.energy + 4 * warp);
    transform.column_first_pass(pixels.z);
  }
  __syncthreads();
  transform.column_second_pass();
  __syncthreads();
  Complex a[8];
  {
    Complex b[8];
    transform.row_first_pass(a, b);
    __syncwarp();
    transform.keep_rows(a, b);
    __syncwarp();
    transform.row_second_pass(a, b);
    __syncwarp();
    if (transform.has_packed_row()) transform.keep_packed(a, b);
    Transform::product(a, b);
  }
  if (transform.has_packed_row()) {
    __syncwarp();
    transform.multiply_packed();
    __syncwarp();
    transform.take_packed(a);
    __syncwarp();
  }
  transform.inverse_row_first_pass(a);
  __syncwarp();
  transform.inverse_row_second_pass(a);
  __syncwarp();
  transform.keep_shifts(a);
  __syncthreads();
  int const radius = job.search_radius_px;
  if (transform.has_columns(radius)) {
    transform.inverse_column_first_pass(radius);
    __syncwarp();
    transform.inverse_column_second_pass(a);
    __syncwarp();
    transform.keep_plane(a);
  } else if (warp == warps - 1) {
    double const scale = scale_of(own.energy, job);
    if (lane == 0) own.scale = scale;
  }
  __syncthreads();

  // Find the peaks.
  auto const plane = transform.plane(radius);
  if (warp < SearchBlock::warps) {
    HighestPeaks const highest = search_block(plane, radius, SearchBlock(thread, radius));
    if (lane == 0) own.highest[warp] = highest;
  }
  __syncthreads();
  if (warp != 0) return;
  double const scale = own.scale;
  if (scale == 0.0) {
    if (lane == 0) write_no_result(WindowCorrelation::Outcome::no_signal, result);
    return;
  }
  write_peaks(plane, radius, own.highest, SearchBlock::warps, reinterpret_cast<PlanePeak<float>*>(own.values),
              own.found, scale, result);
}

}  // namespace

void correlate_windows_of_64(WindowJob const& job, WindowPeaks* peaks) {
  allow_shared_bytes(correlate_window_of_64, sizeof(BlockMemory));
  GLADSTONE_EXPECTS(job.search_radius_px <= Transform::largest_radius);
  constexpr int most_rows = 65535;  // maximum number of window rows per launch
  for (int first = 0; first < job.grid.rows; first += most_rows) {
    dim3 const blocks(static_cast<unsigned>(job.grid.columns),
                      static_cast<unsigned>(std::min(most_rows, job.grid.rows - first)));
    correlate_window_of_64<<<blocks, Transform::threads, sizeof(BlockMemory)>>>(job, first, peaks);
    check_launch("correlate_window_of_64");
  }
}

}  // namespace gladstone::cuda::inline correlation
