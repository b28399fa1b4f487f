#pragma once

#include "analysis/correlation/window_ops.h"
#include "cuda/correlation/small_transform.h"

/// Correlation plane of a window with transforms of length outer x inner, by a thread block with shared memory. A
/// transform takes two steps: transforms of `outer` values at a distance of `inner`, then of `inner` adjacent values.
/// Wave number k is then at place(k); inverse transforms perform the steps in reverse order.
///
/// With a and b the windows, z = a + i b:
///  1. transform columns of z along y, then rows along x (column_first_pass, column_second_pass, row_first_pass,
///     row_second_pass);
///  2. form the cross spectrum for wave numbers kx <= size/2, which suffice since planes are real, and transform it
///     back along y (product, inverse_column_second_pass);
///  3. transform back along x, two rows of the plane as one complex line, for those rows only that the peak search
///     reads (inverse_row_first_pass, inverse_row_second_pass).
/// A step is the work of one thread between two barriers. Between barriers, no two threads access the same memory
/// unless both only read.
///
/// GLADSTONE_KEEP_LOOP prevents the unrolling of a loop. A kernel that exceeds the instruction cache is limited by
/// instruction fetches.
#ifdef __CUDA_ARCH__
#define GLADSTONE_KEEP_LOOP _Pragma("unroll 1")
#else
#define GLADSTONE_KEEP_LOOP
#endif

namespace gladstone::cuda::inline correlation {

/// Filter of scc, which leaves the cross spectrum unchanged.
struct WholeSpectrum {
  GLADSTONE_HD Complex operator()(Complex c, int /*kx*/, int /*ky*/) const { return c; }
};

template <int outer, int inner, int threads_of_block>
struct FactoredTransform {
  static constexpr int size = outer * inner;
  static constexpr int threads = threads_of_block;
  static constexpr int groups = threads / size;  ///< number of threads per line
  static constexpr int pitch = size + 3;         ///< row stride; odd, with two extra columns for the wave numbers kx =
                                                 ///< 0 and size/2
  static constexpr int largest_radius = size / 3;                           ///< largest search radius [px]
  static constexpr int plane_pitch = (2 * largest_radius + 9 + 3) / 4 * 4;  ///< row stride of the plane [floats]
  static_assert(size % 4 == 0 && size >= 32 && threads % size == 0);

  Complex* memory;       ///< values(radius)
  Complex const* roots;  ///< exp(-2 pi i k / size)
  int thread;
  int line = thread % size;
  int group = thread / size;

  /// Row of the memory at which the joined lines begin, each with two rows of the plane. They are stored behind the
  /// window if its own rows do not suffice.
  GLADSTONE_HD static constexpr int first_joined(int radius) { return 3 * radius + 5 < size ? radius + 3 : size; }
  GLADSTONE_HD static constexpr int joined(int radius) { return radius + 2; }
  static constexpr int values(int radius) {
    return pitch * (first_joined(radius) < size ? size : size + joined(radius));
  }
  GLADSTONE_HD static constexpr int place(int k) { return k % outer * inner + k / outer; }

  /// Applies `weighted` to the window's pixels in memory, and performs the first step of the transform along y.
  /// @param weighted  weighted(pixel, y) returns z of a pixel in row y
  /// @param side  side of the window [px]; z is 0 beyond it
  template <class Weighted>
  GLADSTONE_HD void column_first_pass(int side, Weighted const& weighted) const {
    if (line >= side) return;
    GLADSTONE_KEEP_LOOP
    for (int n = group; n < inner; n += groups) {
      Complex* const column = memory + n * pitch + line;
      Complex z[outer];
      for (int k = 0; k < outer; ++k)
        z[k] = k * inner + n < side ? weighted(column[k * inner * pitch], k * inner + n) : Complex{0.0f, 0.0f};
      small_transform<outer, -1, 1>(z);
      for (int k = 0; k < outer; ++k) column[k * inner * pitch] = z[k] * roots[k * n];
    }
  }

  GLADSTONE_HD void column_second_pass(int side) const {
    if (line >= side) return;
    GLADSTONE_KEEP_LOOP
    for (int k = group; k < outer; k += groups) transform_neighbours(memory + k * inner * pitch + line, pitch);
  }

  GLADSTONE_HD void row_first_pass(int side) const {
    GLADSTONE_KEEP_LOOP
    for (int n = group; n < inner; n += groups) {
      Complex* const row = memory + line * pitch + n;
      Complex z[outer];
      for (int k = 0; k < outer; ++k) z[k] = k * inner + n < side ? row[k * inner] : Complex{0.0f, 0.0f};
      small_transform<outer, -1, 1>(z);
      for (int k = 0; k < outer; ++k) row[k * inner] = z[k] * roots[k * n];
    }
  }

  GLADSTONE_HD void row_second_pass() const {
    GLADSTONE_KEEP_LOOP
    for (int k = group; k < outer; k += groups) transform_neighbours(memory + line * pitch + k * inner, 1);
  }

  /// Forms the cross spectrum, applies the filter, and performs the first step of the inverse transform along y.
  template <class Filter>
  GLADSTONE_HD void product(Filter const& filter) const {
    GLADSTONE_KEEP_LOOP
    for (int task = thread; task < waves * outer; task += threads) {
      int const kx = wave(task % waves), ky = task / waves;
      Complex const* const here = memory + ky * inner * pitch + place(kx);
      Complex const* const mirror = memory + (outer - ky) % outer * inner * pitch + place((size - kx) % size);
      Complex c[inner];
      for (int k = 0; k < inner; ++k) {
        Complex const z = here[k * pitch], m = mirror[(ky > 0 ? inner - 1 - k : (inner - k) % inner) * pitch];
        Vec2<float> const both = cross_spectrum(z.re, z.im, m.re, m.im);
        c[k] = filter(Complex{both.x, both.y}, kx, ky + outer * k);
      }
      small_transform<inner, 1, 1>(c);
      Complex* const out = memory + ky * inner * pitch + wave_column(kx);
      for (int k = 0; k < inner; ++k) out[k * pitch] = c[k] * conj(roots[ky * k]);
    }
  }

  GLADSTONE_HD void inverse_column_second_pass() const {
    GLADSTONE_KEEP_LOOP
    for (int task = thread; task < waves * inner; task += threads) {
      Complex* const column = memory + task / waves * pitch + wave_column(wave(task % waves));
      Complex z[outer];
      for (int k = 0; k < outer; ++k) z[k] = column[k * inner * pitch];
      small_transform<outer, 1, 1>(z);
      for (int k = 0; k < outer; ++k) column[k * inner * pitch] = z[k];
    }
  }

  /// Joins rows dy and dy + 1, and performs the first step of the inverse transform along x.
  GLADSTONE_HD void inverse_row_first_pass(int radius) const {
    int const lines = joined(radius);
    GLADSTONE_KEEP_LOOP
    for (int task = thread; task < lines * outer; task += threads) {
      int const pair = task % lines, kx = task / lines, dy = 2 * pair - radius - 1;
      Complex const* const first = memory + (dy < 0 ? dy + size : dy) * pitch;
      Complex const* const second = memory + (dy + 1 < 0 ? dy + 1 + size : dy + 1) * pitch;
      Complex z[inner];
      for (int k = 0; k < inner; ++k) {
        int const here = kx + outer * k;
        bool const mirrored = here > size / 2;
        int const column = wave_column(mirrored ? size - here : here);
        Complex const a = first[column], b = second[column];
        z[k] = mirrored ? Complex{a.re + b.im, b.re - a.im} : Complex{a.re - b.im, a.im + b.re};
      }
      small_transform<inner, 1, 1>(z);
      Complex* const out = memory + (first_joined(radius) + pair) * pitch + kx * inner;
      for (int k = 0; k < inner; ++k) out[k] = z[k] * conj(roots[kx * k]);
    }
  }

  /// Writes the plane to the beginning of the memory: rows of plane_pitch values, from dy = -radius - 1 on.
  GLADSTONE_HD void inverse_row_second_pass(int radius) const {
    float* const out = centre(radius);
    GLADSTONE_KEEP_LOOP
    for (int task = thread; task < joined(radius) * inner; task += threads) {
      int const pair = task / inner, n = task % inner, dy = 2 * pair - radius - 1;
      Complex const* const in = memory + (first_joined(radius) + pair) * pitch + n;
      Complex z[outer];
      for (int k = 0; k < outer; ++k) z[k] = in[k * inner];
      small_transform<outer, 1, 1>(z);
      for (int k = 0; k < outer; ++k) {
        int const x = k * inner + n, dx = x <= size / 2 ? x : x - size;
        if (dx < -radius - 1 || dx > radius + 1) continue;
        out[dy * plane_pitch + dx] = z[k].re;
        out[(dy + 1) * plane_pitch + dx] = z[k].im;
      }
    }
  }

  /// Returns the address of shift (0, 0) of the plane; groups of four values from (-radius, dy) on are aligned.
  GLADSTONE_HD float* centre(int radius) const {
    return reinterpret_cast<float*>(memory) + (radius + 1) * plane_pitch + radius + 4;
  }
  /// Returns the memory after the plane: pitch * joined(radius) values.
  GLADSTONE_HD Complex* behind_plane(int radius) const { return memory + first_joined(radius) * pitch; }

 private:
  static constexpr int waves = size / 2 + 1;

  /// Enumerates the wave numbers 0 .. size/2 so that consecutive ones are mostly adjacent in memory.
  GLADSTONE_HD static constexpr int wave(int index) {
    constexpr int whole = inner / 2;
    return index < outer * whole ? index / whole + outer * (index % whole) : index;
  }
  /// Returns the column for the products of wave number kx. Self-mirrored wave numbers get columns outside the
  /// spectrum, because other threads still read their values.
  GLADSTONE_HD static constexpr int wave_column(int kx) {
    return kx == 0 ? size : (kx == size / 2 ? size + 1 : place(kx));
  }

  GLADSTONE_HD static void transform_neighbours(Complex* values, int step) {
    Complex z[inner];
    for (int k = 0; k < inner; ++k) z[k] = values[k * step];
    small_transform<inner, -1, 1>(z);
    for (int k = 0; k < inner; ++k) values[k * step] = z[k];
  }
};

}  // namespace gladstone::cuda::inline correlation
