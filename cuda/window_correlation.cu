#include "cuda/correlation_kernels.h"
#include "cuda/launch.h"
#include "cuda/peak_search.cuh"
#include "cuda/register_fourier.cuh"

/// One block correlates one window, with as many threads as its support has columns, and nothing but the result leaves
/// it. With a and b the windows, z = a + i b and tilde a transform along y:
///  1. thread x holds column x: mean, weights, energies, transform along y;
///  2. threads 2 k and 2 k + 1 take row k of the spectra of a and of b, k < size/2 (the others follow by symmetry), and
///     transform along x; rows 0 and size/2, both of real columns, share a place as real and imaginary part;
///  3. they swap half their values, form conj(A) B, one at even and one at odd wave numbers, and transform back along
///  x;
///  4. each thread takes columns x and x + size/2 of the plane, joined as a complex number, of every second row,
///     and transforms back along y.
namespace gladstone::cuda {
namespace {

constexpr unsigned all_lanes = 0xffffffffu;

/// Sums of `count` values over all threads of a block of `size` threads, in an order that is fixed.
/// @param slots size/32 * count values of shared memory, not used by anything else
template <int size, int count>
__device__ void block_sums(float (&value)[count], float* slots) {
#pragma unroll
  for (int k = 0; k < count; ++k)
#pragma unroll
    for (int offset = 16; offset > 0; offset /= 2) value[k] += __shfl_xor_sync(all_lanes, value[k], offset);
  if constexpr (size > 32) {
    if (threadIdx.x % 32u == 0)
#pragma unroll
      for (int k = 0; k < count; ++k) slots[threadIdx.x % size / 32u * count + k] = value[k];
    __syncthreads();
#pragma unroll
    for (int k = 0; k < count; ++k) {
      value[k] = slots[k];
#pragma unroll
      for (int warp = 1; warp < size / 32; ++warp) value[k] += slots[warp * count + k];
    }
  }
}

template <int size>
struct Layout {
  static constexpr int half = size / 2;
  static constexpr int spectrum_pitch = size + 1;
  // rows of the half-transformed plane: even and odd part, their distance an odd multiple of 8 to spread the banks
  static constexpr int odd_part = half + 8;
  static constexpr int parts_pitch = size + 9;
  static constexpr int plane_pitch = size == 32 ? 48 : size;
  static constexpr int warps = size / 32;
  static constexpr int copies = size == 32 ? 1 : 2;  // of the code of a transform: what was faster
  static constexpr int values = size * spectrum_pitch;
  // behind the plane: room for all maxima; no two are neighbours
  static constexpr int search_width = 2 * (size / 4) + 1;
  static constexpr int most_maxima = (search_width + 1) * (search_width + 1) / 4;
  static_assert(sizeof(float) * size * plane_pitch + sizeof(PlanePeak<float>) * most_maxima <=
                sizeof(Complex) * values);
};

/// What the threads of one window share.
template <int size>
struct alignas(16) WindowMemory {
  Complex values[Layout<size>::values];
  Complex packed[2][size];
  float weight_y[size];
  float slots[3][Layout<size>::warps * 4];
  HighestPeaks highest[Layout<size>::warps];
  PeakList<float> found;
};

/// Wave number k of rows 0 and size/2 at once: with P = A_0 + i A_half and R likewise of b, C_0 + i C_half at k, where
/// C = conj(A) B; M and S are P and R at -k.
__device__ Complex packed_product(Complex p, Complex m, Complex r, Complex s) {
  Complex const first = (conj(p) + m) * (r + conj(s));
  Complex const second = (conj(p) - m) * (r - conj(s));
  return {0.25f * (first.re - second.im), 0.25f * (first.im + second.re)};
}

/// Leaves that there is nothing to measure.
__device__ void leave_nothing(WindowCorrelation::Outcome why, WindowPeaks& peaks) {
  peaks.outcome = why;
  peaks.count = 0;
  peaks.scale = 0.0;
  for (PeakSample& sample : peaks.peak) sample = {};  // measure_peaks reads the heights of absent peaks, too
}

/// @param turns 1: how often a transform is repeated in the other direction; where Layout::copies is 1 the compiler
/// must not know it, so that there is one copy of the code
template <int size, int windows_per_block, int blocks_per_multiprocessor>
__global__ void __launch_bounds__(size* windows_per_block, blocks_per_multiprocessor)
    correlate_window(WindowJob const job, WindowPeaks* all_peaks, int const turns) {
  using L = Layout<size>;
  constexpr int half = L::half;
  extern __shared__ __align__(16) unsigned char memory[];
  // the windows of a block go through the code together, which is long: the kernel is bound by fetching it
  int const thread = static_cast<int>(threadIdx.x) % size, place = static_cast<int>(threadIdx.x) / size;
  auto const window = static_cast<long long>(blockIdx.x) * windows_per_block + place;
  if (window >= static_cast<long long>(job.grid.size())) return;
  WindowMemory<size>& own = reinterpret_cast<WindowMemory<size>*>(memory)[place];
  Complex* const shared = own.values;
  int const column = static_cast<int>(window) % job.grid.columns, row = static_cast<int>(window) / job.grid.columns;
  WindowPeaks& result = all_peaks[window];

  // 1. column `thread` of both images; beyond the border the nearest pixel, with weight 0
  Complex z[size];
  {
    int const columns = job.pair.columns, rows = job.pair.rows;
    int const first_x = job.x.first(column), first_y = job.y.first(row);
    GreyPair const* const image = job.pair.pixels + min(max(first_x + thread, 0), columns - 1);
    auto const pixel = [&](int y) {
      GreyPair const grey = image[static_cast<long long>(y) * columns];
      return Complex{grey.reference, grey.flow};
    };
    if (first_y >= 0 && first_y + size <= rows) {
#pragma unroll
      for (int y = 0; y < size; ++y) z[y] = pixel(first_y + y);
    } else {
#pragma unroll
      for (int y = 0; y < size; ++y) z[y] = pixel(min(max(first_y + y, 0), rows - 1));
    }
  }
  float const weight_x = job.x.weight(column)[thread];
  own.weight_y[thread] = job.y.weight(row)[thread];
  __syncthreads();
  float const full = static_cast<float>(job.x.sum(column) * job.y.sum(row));
  float sums[2] = {0.0f, 0.0f};
#pragma unroll
  for (int y = 0; y < size; ++y) {
    sums[0] += own.weight_y[y] * z[y].re;
    sums[1] += own.weight_y[y] * z[y].im;
  }
  sums[0] *= weight_x;
  sums[1] *= weight_x;
  block_sums<size>(sums, own.slots[0]);
  float mean_a = sums[0] / full, mean_b = sums[1] / full;
  if (isnan(sums[0]) || isnan(sums[1])) {  // pixels that are not known
    float known[3] = {0.0f, 0.0f, 0.0f};
#pragma unroll
    for (int y = 0; y < size; ++y) {
      bool const both = !isnan(z[y].re) && !isnan(z[y].im);
      float const weight = both ? own.weight_y[y] : 0.0f;
      known[0] += weight;
      known[1] += both ? weight * z[y].re : 0.0f;
      known[2] += both ? weight * z[y].im : 0.0f;
    }
#pragma unroll
    for (float& sum : known) sum *= weight_x;
    block_sums<size>(known, own.slots[1]);
    if (known[0] < smallest_known_part * full) {
      if (thread == 0) leave_nothing(WindowCorrelation::Outcome::masked, result);
      return;
    }
    mean_a = known[1] / known[0];
    mean_b = known[2] / known[0];
#pragma unroll
    for (int y = 0; y < size; ++y)
      if (isnan(z[y].re) || isnan(z[y].im)) z[y] = {mean_a, mean_b};
  }
  // energies of the rows within the nominal window and of the others
  float energy[4] = {0.0f, 0.0f, 0.0f, 0.0f};
#pragma unroll
  for (int y = 0; y < size; ++y) {
    float const weight = weight_x * own.weight_y[y];
    z[y] = {weight * (z[y].re - mean_a), weight * (z[y].im - mean_b)};
    int const core = y >= size / 4 && y < size - size / 4 ? 2 : 0;
    energy[core] += z[y].re * z[y].re;
    energy[core + 1] += z[y].im * z[y].im;
  }
  energy[0] += energy[2];
  energy[1] += energy[3];
  if (thread < size / 4 || thread >= size - size / 4) energy[2] = energy[3] = 0.0f;
  block_sums<size>(energy, own.slots[2]);
  // the steps below leave out a factor 1/4
  double const scale =
      0.25 * plane_scale({energy[0], energy[1], energy[2], energy[3]}, *job.contrast, job.grid.window_px, size);
  if (scale == 0.0) {
    if (thread == 0) leave_nothing(WindowCorrelation::Outcome::no_signal, result);
    return;
  }
  using Forward = RegisterFourier<size, -1>;
  int const wave = thread / 2, odd = thread % 2;
  float const sign = odd ? -1.0f : 1.0f;  // even threads take a, odd threads b
#pragma unroll L::copies
  for (int turn = 0; turn <= (L::copies == 1 ? turns : 1); ++turn) {  // along y, then along x
    if (turn > 0) {
      // 2. from columns to rows; what is written for rows 0 and `half` makes the sums below give 2 (A_0 + i A_half)
      Complex* const out = shared + thread;
#pragma unroll
      for (int k = 0; k < size; ++k)
        if (k != 0 && k != half) out[k * L::spectrum_pitch] = z[Forward::place(k)];
      Complex const zero = z[Forward::place(0)], nyquist = z[Forward::place(half)];
      out[0] = {zero.re + zero.im, nyquist.re + nyquist.im};
      out[half * L::spectrum_pitch] = {zero.re - zero.im, nyquist.im - nyquist.re};
      __syncthreads();
      Complex const* const direct = shared + wave * L::spectrum_pitch;
      Complex const* const mirror = shared + (wave == 0 ? half : size - wave) * L::spectrum_pitch;
#pragma unroll
      for (int x = 0; x < size; ++x) {
        Complex const d = direct[x], m = mirror[x];
        z[x] = {d.re + sign * m.re, d.im - sign * m.im};  // 2 A, or 2 i B
      }
    }
    Forward::apply(z);
  }

  // 3. the cross spectrum
  if (thread < 32) {
    if (wave == 0)
#pragma unroll
      for (int k = 0; k < size; ++k) own.packed[odd][k] = z[Forward::place(k)];
    __syncwarp();
    for (int k = thread; k <= half; k += 32) {
      int const mirror = (size - k) % size;
      Complex const p = own.packed[0][k], m = own.packed[0][mirror], r = own.packed[1][k], s = own.packed[1][mirror];
      own.packed[0][k] = packed_product(p, m, r, s);
      own.packed[0][mirror] = packed_product(m, p, s, r);
    }
    __syncwarp();
  }
  Complex g[half];
#pragma unroll
  for (int k = 0; k < half; ++k) {
    Complex const even_value = z[Forward::place(2 * k)], odd_value = z[Forward::place(2 * k + 1)];
    Complex const send = odd ? even_value : odd_value, own = odd ? odd_value : even_value;
    Complex const other = {__shfl_xor_sync(all_lanes, send.re, 1), __shfl_xor_sync(all_lanes, send.im, 1)};
    Complex const product = conj(own) * other;  // 4 i C, in odd threads its conjugate from 2 i B and 2 A
    g[k] = {sign * product.im, -product.re};
  }
  if (wave == 0)
#pragma unroll
    for (int k = 0; k < half; ++k) g[k] = own.packed[0][2 * k + odd];
  using Back = RegisterFourier<half, 1>;
  int const x = thread % half, parity = thread / half;
#pragma unroll L::copies
  for (int turn = 0; turn <= (L::copies == 1 ? turns : 1); ++turn) {  // along x, then along y
    if (turn > 0) {
      // 4. from rows to columns
      Complex* const out = shared + wave * L::parts_pitch + odd * L::odd_part;
#pragma unroll
      for (int k = 0; k < half; ++k) out[k] = g[Back::place(k)];
      __syncthreads();
      float const side = parity ? -1.0f : 1.0f;
      Complex rotation;
      sincospif(2.0f * static_cast<float>(x) / size, &rotation.im, &rotation.re);
      // columns x and x + half of row k, from the transforms of the even and the odd wave numbers
      struct Columns {
        Complex near, far;
      };
      auto const columns_of = [&](int k) {
        Complex const e = shared[k * L::parts_pitch + x];
        Complex const o = rotation * shared[k * L::parts_pitch + L::odd_part + x];
        return Columns{e + o, e - o};
      };
      auto const joined = [](Columns c) { return Complex{c.near.re - c.far.im, c.near.im + c.far.re}; };
      auto const mirrored = [](Columns c) { return Complex{c.near.re + c.far.im, c.far.re - c.near.im}; };
      auto const folded = [&](Complex here, Complex half_on) {
        return Complex{here.re + side * half_on.re, here.im + side * half_on.im};
      };
      Columns const packed_row = columns_of(0);
      g[0] = folded({packed_row.near.re, packed_row.far.re}, {packed_row.near.im, packed_row.far.im});
#pragma unroll
      for (int k = 1; k <= half / 2; ++k) {
        Columns const here = columns_of(k), there = columns_of(half - k);
        g[k] = folded(joined(here), mirrored(there));
        if (k < half - k) g[half - k] = folded(joined(there), mirrored(here));
      }
      if (parity)
#pragma unroll
        for (int k = 1; k < half; ++k) g[k] = g[k] * unit_root<size, 1>(k);
    }
    Back::apply(g);
    __syncthreads();
  }
  float* const plane_values = reinterpret_cast<float*>(shared);
  {
    float* const out = plane_values + parity * L::plane_pitch + x;
#pragma unroll
    for (int k = 0; k < half; ++k) {
      Complex const value = g[Back::place(k)];
      float* const line = out + (2 * k + half) % size * L::plane_pitch;
      line[half] = value.re;
      line[0] = value.im;
    }
  }
  __syncthreads();

  // the peaks
  CentredPlane<L::plane_pitch> const plane{plane_values + half * L::plane_pitch + half};
  int const radius = job.search_radius_px, warp = thread / 32;
  int const share = (2 * radius + L::warps) / L::warps, first = warp * share - radius;
  HighestPeaks const highest = search_rows(plane, radius, first, min(radius + 1, first + share));
  if (thread % 32 == 0) own.highest[warp] = highest;
  __syncthreads();
  if (thread >= 32) return;
  PlanePeak<float> peak;
  auto* const list = reinterpret_cast<PlanePeak<float>*>(plane_values + size * L::plane_pitch);
  int const count = join_shares(plane, radius, own.highest, L::warps, list, own.found, peak);
  if (thread < PeakList<float>::capacity) {
    bool const there = thread < count;
    int const dx = there ? peak.x : 0, dy = there ? peak.y : 0;
    result.peak[thread] = {
        dx, dy, there ? peak.height : 0.0f, plane(dx - 1, dy), plane(dx + 1, dy), plane(dx, dy - 1), plane(dx, dy + 1)};
  }
  if (thread == 0) {
    result.outcome = WindowCorrelation::Outcome::measured;
    result.count = count;
    result.scale = scale;
  }
}

/// The five values as a plane.
struct SampledPlane {
  PeakSample sample;
  __device__ float operator()(int x, int y) const {
    int const dx = x - sample.x, dy = y - sample.y;
    if (dx != 0) return dx < 0 ? sample.left : sample.right;
    return dy == 0 ? sample.centre : (dy < 0 ? sample.above : sample.below);
  }
};

/// The place of one peak along one axis, thread by thread: axes, then peaks, then windows.
__global__ void measure_peaks(WindowJob const job, WindowPeaks const* all_peaks) {
  constexpr int parts = 2 * PeakList<float>::capacity;
  long long const at = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  long long const window = at / parts;
  if (window >= static_cast<long long>(job.grid.size())) return;
  int const which = static_cast<int>(at % parts) / 2;
  Axis const axis = at % 2 == 0 ? Axis::x : Axis::y;
  int const place =
      axis == Axis::x ? static_cast<int>(window % job.grid.columns) : static_cast<int>(window / job.grid.columns);
  WindowPeaks const& peaks = all_peaks[window];
  WindowCorrelation& result = job.results[window];
  double shift = 0.0;
  if (which < peaks.count) {
    SampledPlane const plane{peaks.peak[which]};
    shift = refined_shift(plane, {plane.sample.x, plane.sample.y, plane.sample.centre}, axis,
                          axis == Axis::x ? job.x : job.y, place);
  }
  (axis == Axis::x ? result.shift[which].x : result.shift[which].y) = shift;
  if (at % parts != 0) return;
  write_outcome(peaks.count, peaks.peak[0].centre, peaks.peak[1].centre, peaks.scale, result);
  if (peaks.outcome != WindowCorrelation::Outcome::measured) result.outcome = peaks.outcome;
}

template <int size, int windows_per_block, int blocks_per_multiprocessor>
void launch(WindowJob const& job, WindowPeaks* peaks) {
  auto const kernel = correlate_window<size, windows_per_block, blocks_per_multiprocessor>;
  constexpr std::size_t bytes = windows_per_block * sizeof(WindowMemory<size>);
  allow_shared_bytes(kernel, bytes);
  auto const blocks = static_cast<unsigned>((job.grid.size() + windows_per_block - 1) / windows_per_block);
  kernel<<<blocks, size * windows_per_block, bytes>>>(job, peaks, 1);
  check_launch("correlate_window");
}

}  // namespace

bool fits_registers(int size) { return size == 32 || size == 64; }

void correlate_windows_in_registers(WindowJob const& job, WindowPeaks* peaks) {
  if (job.x.size == 64)
    launch<64, 2, 3>(job, peaks);
  else
    launch<32, 1, 18>(job, peaks);
  constexpr unsigned threads = 192;
  auto const parts = 2 * PeakList<float>::capacity * job.grid.size();
  measure_peaks<<<static_cast<unsigned>((parts + threads - 1) / threads), threads>>>(job, peaks);
  check_launch("measure_peaks");
}

}  // namespace gladstone::cuda
