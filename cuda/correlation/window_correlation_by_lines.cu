#include <cmath>

#include "cuda/correlation/block_sums.cuh"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/phase_spectrum.cuh"
#include "cuda/correlation/window_peaks.cuh"
#include "cuda/device/launch.h"
#include "render/base/contracts.h"
#include "render/base/units.h"

/// Correlation of windows of any size: one window per block, one line per warp, in shared or global memory. Slower than
/// the specialised kernels.
namespace gladstone::cuda::inline correlation {
namespace {

constexpr unsigned all_lanes = 0xffffffffu;

/// Transformed plane (real parts), with shifts (dx, dy) modulo its size.
struct WrappedPlane {
  Complex const* values;
  int size;
  int pitch;
  __device__ float operator()(int dx, int dy) const {
    return values[static_cast<long long>(dy < 0 ? dy + size : dy) * pitch + (dx < 0 ? dx + size : dx)].re;
  }
};

/// Transforms a line in `from` by one warp, with `to` as a buffer of equal length; conjugated roots give the inverse
/// transform. Stockham's algorithm: every stage reads `radix` values at the full stride and writes them adjacently, so
/// that the result is in natural order.
/// @return address of the result
__device__ Complex* transform_line(LinePlan const& plan, Complex const* roots, bool back, Complex* from, Complex* to) {
  int const lane = static_cast<int>(threadIdx.x % 32u), size = plan.size;
  auto const root = [&](int k) { return back ? conj(roots[k]) : roots[k]; };
  int done = 1;
  for (int stage = 0; stage < plan.stages; ++stage) {
    int const radix = plan.radix[stage], stride = size / radix, turn = stride / done;
    if (radix == 4) {
      for (int j = lane; j < stride; j += 32) {
        int const low = j % done, step = low * turn;
        Complex v[4];
        for (int q = 0; q < 4; ++q) v[q] = from[j + q * stride] * root(q * step);
        if (back)
          small_transform<4, 1, 1>(v);
        else
          small_transform<4, -1, 1>(v);
        for (int p = 0; p < 4; ++p) to[(j - low) * 4 + low + p * done] = v[p];
      }
    } else {
      for (int index = lane; index < size; index += 32) {
        int const j = index % stride, p = index / stride, low = j % done, step = (low * turn + p * stride) % size;
        Complex sum{0.0f, 0.0f};
        for (int q = 0, k = 0; q < radix; ++q) {
          sum = sum + from[j + q * stride] * root(k);
          k += step;
          if (k >= size) k -= size;
        }
        to[(j - low) * radix + low + p * done] = sum;
      }
    }
    done *= radix;
    __syncwarp();
    Complex* const result = to;
    to = from;
    from = result;
  }
  return from;
}

/// Transforms the lines first .. first + count - 1 (modulo the size) of a window, one line per warp.
__device__ void transform_lines(LinePlan const& plan, Complex const* roots, bool back, Complex* window, int line_step,
                                int value_step, int first, int count, Complex* scratch) {
  int const lane = static_cast<int>(threadIdx.x % 32u), warp = static_cast<int>(threadIdx.x / 32u), size = plan.size;
  Complex* const own = scratch + static_cast<long long>(warp) * 2 * size;
  for (int n = warp; n < count; n += plan.warps) {
    Complex* const line = window + static_cast<long long>((first + n + size) % size) * line_step;
    for (int k = lane; k < size; k += 32) own[k] = line[static_cast<long long>(k) * value_step];
    __syncwarp();
    Complex const* const result = transform_line(plan, roots, back, own, own + size);
    for (int k = lane; k < size; k += 32) line[static_cast<long long>(k) * value_step] = result[k];
    __syncwarp();
  }
  __syncthreads();
}

/// Calls visit(j, i, a, b, weight) for this thread's share of a window's pixels; the weight is 0 for unknown pixels.
template <class Visit>
__device__ void for_each_pixel(WindowJob const& job, int column, int row, Visit const& visit) {
  int const size = job.side, first_x = job.x.first(column) + job.margin, first_y = job.y.first(row) + job.margin;
  float const* const weight_x = job.x.weight(column) + job.margin;
  float const* const weight_y = job.y.weight(row) + job.margin;
  for (int k = static_cast<int>(threadIdx.x); k < size * size; k += static_cast<int>(blockDim.x)) {
    int const i = k % size, j = k / size, x = first_x + i, y = first_y + j;
    float a = 0.0f, b = 0.0f, weight = 0.0f;
    if (x >= 0 && x < job.pair.columns && y >= 0 && y < job.pair.rows) {
      long long const at = static_cast<long long>(y) * job.pair.columns + x;
      a = job.pair.pixels[at].reference;
      b = job.pair.pixels[at].flow;
      if (isnan(a) || isnan(b))
        a = b = 0.0f;
      else
        weight = weight_x[i] * weight_y[j];
    }
    visit(j, i, a, b, weight);
  }
}

/// Replaces the spectrum of a + i b by conj(A) B, for wave numbers k and -k together.
/// @param particles  weights of the phases along one axis for rpc; null: magnitudes are retained
__device__ void form_cross_spectrum(Complex* window, int size, int pitch, float const* particles) {
  for (int k = static_cast<int>(threadIdx.x); k < (size / 2 + 1) * size; k += static_cast<int>(blockDim.x)) {
    int const x = k % size, y = k / size, mirror_x = (size - x) % size, mirror_y = (size - y) % size;
    if (y == mirror_y && x > mirror_x) continue;  // skip the second half of a row that is its own mirror
    Complex& here = window[static_cast<long long>(y) * pitch + x];
    Complex& there = window[static_cast<long long>(mirror_y) * pitch + mirror_x];
    Vec2<float> const product = cross_spectrum(here.re, here.im, there.re, there.im);
    here = {product.x, product.y};
    if (particles != nullptr) here = PhaseSpectrum{particles}(here, x, y);
    there = conj(here);
  }
  __syncthreads();
}

__global__ void correlate_window_by_lines(WindowJob const job, LinePlan const plan, Complex* all_scratch,
                                          WindowPeaks* all_peaks) {
  extern __shared__ Complex memory[];
  __shared__ double slots_of_sums[32 * 3], slots_of_energy[32 * 4];
  __shared__ PeakList<float> found;
  int const side = job.side, size = plan.size, pitch = plan.pitch(), thread = static_cast<int>(threadIdx.x);
  Complex* const roots = memory;
  Complex* const lines = memory + size;
  Complex* const window = plan.window_in_shared ? lines + static_cast<long long>(plan.warps) * 2 * size
                                                : all_scratch + static_cast<long long>(blockIdx.x) * pitch * size;
  for (int k = thread; k < size; k += static_cast<int>(blockDim.x)) roots[k] = job.roots[k];

  for (unsigned index = blockIdx.x; index < job.grid.size(); index += gridDim.x) {
    __syncthreads();  // the previous window has been finished
    int const column = static_cast<int>(index) % job.grid.columns, row = static_cast<int>(index) / job.grid.columns;
    WindowPeaks& result = all_peaks[index];

    double sums[3] = {0.0, 0.0, 0.0};
    for_each_pixel(job, column, row, [&](int, int, float a, float b, float weight) {
      sums[0] += weight;
      sums[1] += static_cast<double>(weight) * a;
      sums[2] += static_cast<double>(weight) * b;
    });
    block_sums(sums, slots_of_sums);
    if (sums[0] < min_valid_weight_fraction * job.x.sum(column) * job.y.sum(row)) {
      if (thread == 0) write_no_result(WindowCorrelation::Outcome::masked, result);
      continue;
    }
    float const mean_a = static_cast<float>(sums[1] / sums[0]), mean_b = static_cast<float>(sums[2] / sums[0]);
    for (int k = thread; size > side && k < size * size; k += static_cast<int>(blockDim.x))
      window[static_cast<long long>(k / size) * pitch + k % size] = {0.0f, 0.0f};
    __syncthreads();
    int const outer = job.x.size / 4 - job.margin;
    double energy[4] = {0.0, 0.0, 0.0, 0.0};
    for_each_pixel(job, column, row, [&](int j, int i, float a, float b, float weight) {
      Complex const z{weight * (a - mean_a), weight * (b - mean_b)};
      window[static_cast<long long>(j) * pitch + i] = z;
      bool const core = i >= outer && i < side - outer && j >= outer && j < side - outer;
      energy[0] += static_cast<double>(z.re) * z.re;
      energy[1] += static_cast<double>(z.im) * z.im;
      energy[2] += core ? static_cast<double>(z.re) * z.re : 0.0;
      energy[3] += core ? static_cast<double>(z.im) * z.im : 0.0;
    });
    block_sums(energy, slots_of_energy);
    double const scale = plane_scale({static_cast<float>(energy[0]), static_cast<float>(energy[1]),
                                      static_cast<float>(energy[2]), static_cast<float>(energy[3])},
                                     *job.contrast, job.grid.window_px, size);
    if (scale == 0.0) {
      if (thread == 0) write_no_result(WindowCorrelation::Outcome::no_signal, result);
      continue;
    }

    int const radius = job.search_radius_px;
    transform_lines(plan, roots, false, window, pitch, 1, 0, size, lines);
    transform_lines(plan, roots, false, window, 1, pitch, 0, size, lines);
    form_cross_spectrum(window, size, pitch, job.particles);
    transform_lines(plan, roots, true, window, 1, pitch, 0, size, lines);
    int const needed = min(size, 2 * radius + 3);
    transform_lines(plan, roots, true, window, pitch, 1, -(radius + 1), needed, lines);
    if (thread >= 32) continue;

    // Find the peaks, one row of shifts at a time; `lines` has capacity for the maxima of a row.
    WrappedPlane const plane{window, size, pitch};
    auto* const list = reinterpret_cast<PlanePeak<float>*>(lines);
    if (thread == 0) found = {};
    for (int dy = -radius; dy <= radius; ++dy) {
      int count = 0;
      for (int first = -radius; first <= radius; first += 32) {
        int const dx = first + thread;
        float const height = dx <= radius ? plane(dx, dy) : 0.0f;
        bool const maximum = height > 0.0f && is_maximum(plane, dx, dy, height);
        unsigned const all = __ballot_sync(all_lanes, maximum);
        if (maximum)
          list[count + __popc(all & ((1u << thread) - 1u))] = {dx, dy, refined_peak(plane, dx, dy, height).height};
        count += __popc(all);
      }
      __syncwarp();
      if (thread == 0) insert_listed(found, list, count);
      __syncwarp();
    }
    if (thread == 0)
      prefer_nearest(plane, radius, found,
                     [&](auto const& visit) { visit_candidate_peaks(plane, radius, found, visit); });
    __syncwarp();
    write_peak_samples(plane, found.count, found.peak[thread < PeakList<float>::capacity ? thread : 0],
                       job.particles != nullptr ? 1.0 : scale, result);
  }
}

}  // namespace

LinePlan make_line_plan(int size) {
  GLADSTONE_EXPECTS(size > 0 && size <= 1024);
  std::size_t const most_shared =
      std::min<std::size_t>(227 * 1024 - 4096, most_shared_bytes(correlate_window_by_lines));
  LinePlan plan{};
  plan.size = size;
  int left = size;
  while (left % 4 == 0) plan.radix[plan.stages++] = 4, left /= 4;
  for (int radix = 2; left > 1; ++radix)
    while (left % radix == 0) plan.radix[plan.stages++] = radix, left /= radix;
  plan.warps = size <= 256 ? 16 : 8;
  auto const bytes = [&] { return sizeof(Complex) * static_cast<std::size_t>(size) * (1 + 2 * plan.warps); };
  std::size_t const window_bytes = sizeof(float) * plan.window_values();
  if (bytes() + window_bytes > most_shared && size <= 256) plan.warps = 8;
  plan.window_in_shared = bytes() + window_bytes <= most_shared;
  if (!plan.window_in_shared && size <= 256) plan.warps = 16;
  while (bytes() > most_shared && plan.warps > 1) plan.warps /= 2;
  plan.shared_bytes = bytes() + (plan.window_in_shared ? window_bytes : 0);
  return plan;
}

std::vector<Complex> unit_roots(int size) {
  std::vector<Complex> roots;
  for (int k = 0; k < size; ++k) {
    double const angle = -2.0 * pi * k / size;
    roots.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
  }
  return roots;
}

void correlate_windows_by_lines(WindowJob const& job, LinePlan const& plan, float* scratch, int slots,
                                WindowPeaks* peaks) {
  allow_shared_bytes(correlate_window_by_lines, plan.shared_bytes);
  auto const windows = static_cast<unsigned>(job.grid.size());
  unsigned const blocks =
      plan.window_in_shared || windows < static_cast<unsigned>(slots) ? windows : static_cast<unsigned>(slots);
  correlate_window_by_lines<<<blocks, static_cast<unsigned>(32 * plan.warps), plan.shared_bytes>>>(
      job, plan, reinterpret_cast<Complex*>(scratch), peaks);
  check_launch("correlate_window_by_lines");
}

}  // namespace gladstone::cuda::inline correlation
