#include <cmath>

#include "cuda/correlation/block_sums.cuh"
#include "cuda/correlation/factored_transform.h"
#include "cuda/correlation/phase_spectrum.cuh"
#include "cuda/correlation/window_peaks.cuh"
#include "cuda/device/launch.h"
#include "render/base/contracts.h"

/// Correlation of windows with the transform lengths of common passes: one window per block, by FactoredTransform. Only
/// the peaks are written to global memory.
namespace gladstone::cuda::inline correlation {
namespace {

constexpr int most_warps = 32;
constexpr int most_searching = 10;  // maximum number of searching warps: one warp merges all results

/// Shared memory of a block, in front of the window.
template <int size>
struct alignas(16) BlockMemory {
  double scale;
  Complex roots[size];
  float particles[size];
  float weight_y[size];
  float sums[most_warps * 2];
  float known[most_warps * 3];
  float energy[most_warps * 4];
  HighestPeaks highest[most_searching];
  PeakList<float> found;
};

/// Copies a window's pixels to shared memory. Positions outside the image, whose weights are 0, get the nearest pixel.
/// @return this thread's share of the weighted sums of both images
template <class Transform>
__device__ Complex take_pixels(Transform const& transform, WindowJob const& job, int column, int row,
                               float const* weight_y, float weight_x) {
  int const columns = job.pair.columns, rows = job.pair.rows;
  int const first_x = job.x.first(column) + job.margin, first_y = job.y.first(row) + job.margin;
  Complex sum{0.0f, 0.0f};
  if (transform.line >= job.side) return sum;
  GreyPair const* const image = job.pair.pixels + min(max(first_x + transform.line, 0), columns - 1);
  Complex* const out = transform.memory + transform.line;
  auto const take = [&](int y, GreyPair grey) {
    out[y * Transform::pitch] = {grey.reference, grey.flow};
    sum = {sum.re + weight_y[y] * grey.reference, sum.im + weight_y[y] * grey.flow};
  };
  if (first_y >= 0 && first_y + job.side <= rows) {
    GreyPair const* pixel = image + static_cast<long long>(first_y + transform.group) * columns;
#pragma unroll 4
    for (int y = transform.group; y < job.side; y += Transform::groups, pixel += Transform::groups * columns)
      take(y, *pixel);
  } else {
#pragma unroll 1
    for (int y = transform.group; y < job.side; y += Transform::groups)
      take(y, image[static_cast<long long>(min(max(first_y + y, 0), rows - 1)) * columns]);
  }
  return {weight_x * sum.re, weight_x * sum.im};
}

/// Sums over this thread's pixels that are known in both images: weights and weighted grey levels of both. Called only
/// for windows with unknown pixels.
template <class Transform>
__device__ void sum_known_pixels(Transform const& transform, int side, float const* weight_y, float weight_x,
                                 float (&sums)[3]) {
  if (transform.line >= side) return;
  for (int y = transform.group; y < side; y += Transform::groups) {
    Complex const pixel = transform.memory[y * Transform::pitch + transform.line];
    if (isnan(pixel.re + pixel.im)) continue;
    float const weight = weight_x * weight_y[y];
    sums[0] += weight;
    sums[1] += weight * pixel.re;
    sums[2] += weight * pixel.im;
  }
}

template <class Transform, bool phase_only>
__global__ void __launch_bounds__(Transform::threads)
    correlate_window_by_factors(WindowJob const __grid_constant__ job, WindowPeaks* const all_peaks) {
  constexpr int size = Transform::size, threads = Transform::threads, warps = threads / 32;
  static_assert(warps > 1);  // one of the warps does not search
  extern __shared__ __align__(16) unsigned char memory[];
  auto& own = *reinterpret_cast<BlockMemory<size>*>(memory);
  int const thread = static_cast<int>(threadIdx.x);
  int const column = static_cast<int>(blockIdx.x) % job.grid.columns,
            row = static_cast<int>(blockIdx.x) / job.grid.columns;
  WindowPeaks& result = all_peaks[blockIdx.x];
  Transform const transform{reinterpret_cast<Complex*>(memory + sizeof(BlockMemory<size>)), own.roots, thread};
  float const weight_x = transform.line < job.side ? job.x.weight(column)[job.margin + transform.line] : 0.0f;
  for (int k = thread; k < size; k += threads) {
    own.roots[k] = job.roots[k];
    own.weight_y[k] = k < job.side ? job.y.weight(row)[job.margin + k] : 0.0f;
    if constexpr (phase_only) own.particles[k] = job.particles[k];
  }
  __syncthreads();
  Complex const share = take_pixels(transform, job, column, row, own.weight_y, weight_x);
  float const full = static_cast<float>(job.x.sum(column) * job.y.sum(row));
  float sums[2] = {share.re, share.im};
  block_sums(sums, own.sums);
  Complex mean{sums[0] / full, sums[1] / full};
  if (isnan(mean.re + mean.im)) {  // some pixels of the window are unknown
    float known[3] = {0.0f, 0.0f, 0.0f};
    sum_known_pixels(transform, job.side, own.weight_y, weight_x, known);
    block_sums(known, own.known);
    if (known[0] < min_valid_weight_fraction * full) {
      if (thread == 0) write_no_result(WindowCorrelation::Outcome::masked, result);
      return;
    }
    mean = {known[1] / known[0], known[2] / known[0]};
  }
  float energy[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  int const core = job.x.size / 4 - job.margin, core_end = job.side - core;
  bool const column_inside = transform.line >= core && transform.line < core_end;
  transform.column_first_pass(job.side, [&](Complex pixel, int y) {
    float const weight = weight_x * own.weight_y[y];
    Complex const z = isnan(pixel.re + pixel.im)
                          ? Complex{0.0f, 0.0f}
                          : Complex{weight * (pixel.re - mean.re), weight * (pixel.im - mean.im)};
    energy[0] += z.re * z.re;
    energy[1] += z.im * z.im;
    if (column_inside && y >= core && y < core_end) {
      energy[2] += z.re * z.re;
      energy[3] += z.im * z.im;
    }
    return z;
  });
  block_sums(energy, own.energy);
  transform.column_second_pass(job.side);
  __syncthreads();
  transform.row_first_pass(job.side);
  __syncthreads();
  transform.row_second_pass();
  __syncthreads();
  if constexpr (phase_only)
    transform.product(PhaseSpectrum{own.particles});
  else
    transform.product(WholeSpectrum());
  __syncthreads();
  transform.inverse_column_second_pass();
  __syncthreads();
  int const radius = job.search_radius_px;
  transform.inverse_row_first_pass(radius);
  __syncthreads();
  transform.inverse_row_second_pass(radius);
  __syncthreads();

  // A warp searches 32 groups of four shifts at a time. Few warps take part, because each one ranks its own maxima.
  int const blocks = (2 * radius + 1) * ((2 * radius + 4) / 4), warp = thread / 32;
  int const searching = min((blocks + 63) / 64, warps <= most_searching ? warps - 1 : most_searching);
  int const rows_each = (2 * radius + searching) / searching;
  CentredPlane<Transform::plane_pitch> const plane{transform.centre(radius)};
  if (warp < searching) {
    int const begin = warp * rows_each - radius, end = min(begin + rows_each, radius + 1);
    HighestPeaks const highest = search_rows(plane, radius, begin, end);
    if (thread % 32 == 0) own.highest[warp] = highest;
  } else if (thread == 32 * searching) {
    own.scale = plane_scale({energy[0], energy[1], energy[2], energy[3]}, *job.contrast, job.grid.window_px, size);
  }
  __syncthreads();
  if (warp != 0) return;
  double const scale = own.scale;
  if (scale > 0.0)
    write_peaks(plane, radius, own.highest, searching,
                reinterpret_cast<PlanePeak<float>*>(transform.behind_plane(radius)), own.found,
                phase_only ? 1.0 : scale, result);
  else if (thread == 0)
    write_no_result(WindowCorrelation::Outcome::no_signal, result);
}

template <int outer, int inner, int threads>
void launch(WindowJob const& job, WindowPeaks* peaks) {
  using Transform = FactoredTransform<outer, inner, threads>;
  GLADSTONE_EXPECTS(job.search_radius_px <= Transform::largest_radius && job.side <= Transform::size);
  auto* const kernel = job.particles != nullptr ? correlate_window_by_factors<Transform, true>
                                                : correlate_window_by_factors<Transform, false>;
  std::size_t const bytes = sizeof(BlockMemory<Transform::size>) +
                            sizeof(Complex) * static_cast<std::size_t>(Transform::values(job.search_radius_px));
  allow_shared_bytes(kernel, bytes);
  kernel<<<static_cast<unsigned>(job.grid.size()), threads, bytes>>>(job, peaks);
  check_launch("correlate_window_by_factors");
}

/// Table of the supported lengths: for windows of 16 to 64 px.
struct Length {
  int size;
  void (*launch)(WindowJob const& job, WindowPeaks* peaks);
};
constexpr Length lengths[] = {
    {32, launch<8, 4, 128>}, {40, launch<8, 5, 160>},  {48, launch<8, 6, 96>},
    {64, launch<8, 8, 256>}, {96, launch<12, 8, 576>}, {128, launch<16, 8, 1024>},
};

}  // namespace

int factored_size(int least) {
  for (Length const& row : lengths)
    if (row.size >= least) return row.size;
  return 0;
}

void correlate_windows_by_factors(WindowJob const& job, WindowPeaks* peaks) {
  for (Length const& row : lengths)
    if (row.size == job.size) return row.launch(job, peaks);
  GLADSTONE_EXPECTS(!"a factored size");
}

}  // namespace gladstone::cuda::inline correlation
