#include "cuda/correlation/register_fourier.cuh"
#include "cuda/correlation/window_peaks.cuh"
#include "cuda/device/launch.h"

/// Correlation of windows with supports of 32 px: one window per warp, one column per thread. Only the peaks are
/// written to global memory. With a and b the windows, z = a + i b and tilde a transform along y:
///  1. thread x holds column x: mean, weights, energies, transform along y;
///  2. threads 2 k and 2 k + 1 process row k of the spectra of a and b, k < size/2 (the others follow by symmetry),
///     and transform along x; rows 0 and size/2, whose columns are real, share a row as real and imaginary part;
///  3. they exchange half of their values, form conj(A) B, one at even and one at odd wave numbers, and transform
///     back along x;
///  4. each thread processes columns x and x + size/2 of the plane, joined as complex numbers, of every second row,
///     and transforms back along y.
namespace gladstone::cuda::inline correlation {
namespace {

constexpr unsigned all_lanes = 0xffffffffu;

/// Sums `count` values over the block's warp, in a fixed order.
template <int count>
__device__ void warp_sums(float (&value)[count]) {
#pragma unroll
  for (int k = 0; k < count; ++k)
#pragma unroll
    for (int offset = 16; offset > 0; offset /= 2) value[k] += __shfl_xor_sync(all_lanes, value[k], offset);
}

constexpr int size = 32;
constexpr int half = size / 2;
constexpr int spectrum_pitch = size + 1;
// Rows of the half-transformed plane: even and odd parts, at a distance of an odd multiple of 8 to use different banks.
constexpr int odd_part = half + 8;
constexpr int parts_pitch = size + 9;
constexpr int plane_pitch = 48;
constexpr int values = size * spectrum_pitch;
// Memory for all maxima after the plane; two maxima are never adjacent.
constexpr int search_width = 2 * (size / 4) + 1;
constexpr int most_maxima = (search_width + 1) * (search_width + 1) / 4;
static_assert(sizeof(float) * size * plane_pitch + sizeof(PlanePeak<float>) * most_maxima <= sizeof(Complex) * values);

/// Shared memory of a block.
struct alignas(16) BlockMemory {
  Complex values[cuda::values];
  Complex packed[2][size];
  float weight_y[size];
  HighestPeaks highest;
  PeakList<float> found;
};

/// Finds the peaks of one window.
/// @param turns  always 1: number of repetitions of a transform along the other axis. It is not a compile-time
/// constant, so that the long code exists only once: the kernel is limited by instruction fetches.
__global__ void __launch_bounds__(size, 18)
    correlate_window_of_32(WindowJob const job, WindowPeaks* all_peaks, int const turns) {
  extern __shared__ __align__(16) unsigned char memory[];
  BlockMemory& own = *reinterpret_cast<BlockMemory*>(memory);
  int const thread = static_cast<int>(threadIdx.x), window = static_cast<int>(blockIdx.x);
  Complex* const shared = own.values;
  int const column = window % job.grid.columns, row = window / job.grid.columns;
  WindowPeaks& result = all_peaks[window];

  // 1. Read column `thread` of both images. Positions outside the image get the nearest pixel and weight 0.
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
  warp_sums(sums);
  float mean_a = sums[0] / full, mean_b = sums[1] / full;
  if (isnan(sums[0]) || isnan(sums[1])) {  // some pixels of the window are unknown
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
    warp_sums(known);
    if (known[0] < min_valid_weight_fraction * full) {
      if (thread == 0) write_no_result(WindowCorrelation::Outcome::masked, result);
      return;
    }
    mean_a = known[1] / known[0];
    mean_b = known[2] / known[0];
#pragma unroll
    for (int y = 0; y < size; ++y)
      if (isnan(z[y].re) || isnan(z[y].im)) z[y] = {mean_a, mean_b};
  }
  // Energies of the rows within the nominal window, and of the others.
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
  warp_sums(energy);
  // The steps below omit a factor of 1/4.
  double const scale =
      0.25 * plane_scale({energy[0], energy[1], energy[2], energy[3]}, *job.contrast, job.grid.window_px, size);
  if (scale == 0.0) {
    if (thread == 0) write_no_result(WindowCorrelation::Outcome::no_signal, result);
    return;
  }
  using Forward = RegisterFourier<size, -1>;
  int const wave = thread / 2, odd = thread % 2;
  float const sign = odd ? -1.0f : 1.0f;  // even threads process a, odd threads b
#pragma unroll 1
  for (int turn = 0; turn <= turns; ++turn) {  // transforms along y, then along x
    if (turn > 0) {
      // 2. From columns to rows. The values of rows 0 and `half` are chosen so that the sums below give 2 (A_0 + i
      //    A_half).
      Complex* const out = shared + thread;
#pragma unroll
      for (int k = 0; k < size; ++k)
        if (k != 0 && k != half) out[k * spectrum_pitch] = z[Forward::place(k)];
      Complex const zero = z[Forward::place(0)], nyquist = z[Forward::place(half)];
      out[0] = {zero.re + zero.im, nyquist.re + nyquist.im};
      out[half * spectrum_pitch] = {zero.re - zero.im, nyquist.im - nyquist.re};
      __syncthreads();
      Complex const* const direct = shared + wave * spectrum_pitch;
      Complex const* const mirror = shared + (wave == 0 ? half : size - wave) * spectrum_pitch;
#pragma unroll
      for (int x = 0; x < size; ++x) {
        Complex const d = direct[x], m = mirror[x];
        z[x] = {d.re + sign * m.re, d.im - sign * m.im};  // 2 A in even threads, 2 i B in odd ones
      }
    }
    Forward::apply(z);
  }

  // 3. Form the cross spectrum.
  if (wave == 0)
#pragma unroll
    for (int k = 0; k < size; ++k) own.packed[odd][k] = z[Forward::place(k)];
  __syncwarp();
  if (thread <= half) {
    int const mirror = (size - thread) % size;
    Complex const p = own.packed[0][thread], m = own.packed[0][mirror];
    Complex const r = own.packed[1][thread], s = own.packed[1][mirror];
    own.packed[0][thread] = packed_product(p, m, r, s);
    own.packed[0][mirror] = packed_product(m, p, s, r);
  }
  __syncwarp();
  Complex g[half];
#pragma unroll
  for (int k = 0; k < half; ++k) {
    Complex const even_value = z[Forward::place(2 * k)], odd_value = z[Forward::place(2 * k + 1)];
    Complex const send = odd ? even_value : odd_value, own = odd ? odd_value : even_value;
    Complex const other = {__shfl_xor_sync(all_lanes, send.re, 1), __shfl_xor_sync(all_lanes, send.im, 1)};
    Complex const product = conj(own) * other;  // 4 i C; in odd threads its conjugate, from 2 i B and 2 A
    g[k] = {sign * product.im, -product.re};
  }
  if (wave == 0)
#pragma unroll
    for (int k = 0; k < half; ++k) g[k] = own.packed[0][2 * k + odd];
  using Back = RegisterFourier<half, 1>;
  int const x = thread % half, parity = thread / half;
#pragma unroll 1
  for (int turn = 0; turn <= turns; ++turn) {  // transforms along x, then along y
    if (turn > 0) {
      // 4. Exchange from rows to columns.
      Complex* const out = shared + wave * parts_pitch + odd * odd_part;
#pragma unroll
      for (int k = 0; k < half; ++k) out[k] = g[Back::place(k)];
      __syncthreads();
      float const side = parity ? -1.0f : 1.0f;
      Complex rotation;
      sincospif(2.0f * static_cast<float>(x) / size, &rotation.im, &rotation.re);
      // Columns x and x + half of row k, from the transforms of the even and odd wave numbers.
      struct Columns {
        Complex near, far;
      };
      auto const columns_of = [&](int k) {
        Complex const e = shared[k * parts_pitch + x];
        Complex const o = rotation * shared[k * parts_pitch + odd_part + x];
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
    float* const out = plane_values + parity * plane_pitch + x;
#pragma unroll
    for (int k = 0; k < half; ++k) {
      Complex const value = g[Back::place(k)];
      float* const line = out + (2 * k + half) % size * plane_pitch;
      line[half] = value.re;
      line[0] = value.im;
    }
  }
  __syncthreads();

  CentredPlane<plane_pitch> const plane{plane_values + half * plane_pitch + half};
  int const radius = job.search_radius_px;
  HighestPeaks const highest = search_rows(plane, radius, -radius, radius + 1);
  if (thread == 0) own.highest = highest;
  __syncwarp();
  write_peaks(plane, radius, &own.highest, 1, reinterpret_cast<PlanePeak<float>*>(plane_values + size * plane_pitch),
              own.found, scale, result);
}

}  // namespace

void correlate_windows_of_32(WindowJob const& job, WindowPeaks* peaks) {
  constexpr std::size_t bytes = sizeof(BlockMemory);
  allow_shared_bytes(correlate_window_of_32, bytes);
  correlate_window_of_32<<<static_cast<unsigned>(job.grid.size()), size, bytes>>>(job, peaks, 1);
  check_launch("correlate_window_of_32");
}

}  // namespace gladstone::cuda::inline correlation
