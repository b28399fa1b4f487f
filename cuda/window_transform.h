#pragma once

#include "cuda/small_transform.h"

/// The correlation plane of a window of 64 x 64 values by 256 threads, which hold sixteen values each and exchange them
/// through memory that they share. A line of 64 takes two passes of eight values, 64 = 8 x 8, and all passes are short.
///
/// With a and b the windows, z = a + i b and tilde a transform along y, the steps below
///  1. transform columns of z along y (columns_apart, columns_together);
///  2. take rows k < 32 of the spectra of a and of b out of rows k and -k, and transform along x (rows_apart,
///     rows_together); rows 0 and 32, both of real columns, share a place as real and imaginary part;
///  3. form conj(A) B and transform back along x (product, rows_apart_again, rows_together_again);
///  4. transform columns 2 x and 2 x + 1 of the plane, joined as a complex number, back along y (columns_apart_again,
///     columns_together_again).
/// A step is what one thread does between two barriers; the comments say which: all steps of the rows of one warp stay
/// within it. No two threads write, nor one writes and another reads, the same place between two barriers.
///
/// Wave number or shift p + 8 q of the columns lies in row 4 p + q % 4 of the lower (q < 4) or upper half of the
/// memory: a column's second pass leaves its values where it found them, and half-warps, which take rows q and q + 1,
/// meet all banks, since a row is an odd multiple of eight values long.
namespace gladstone::cuda {

struct WindowTransform {
  static constexpr int size = 64;
  static constexpr int threads = 256;
  static constexpr int pitch = 72;
  static constexpr int values = size * pitch;
  static constexpr int upper = 32 * pitch;  ///< where the upper half begins
  static constexpr int plane_pitch = 64;    ///< of the plane, which lies in the lower half

  struct alignas(16) ComplexPair {
    Complex even, odd;
  };
  /// exp(-2 pi i n k / 64), k = 0 .. 7, in row n, whose length keeps eight rows apart.
  struct Roots {
    ComplexPair of[8][5];
  };
  static constexpr Roots make_roots() {
    Roots roots{};
    for (int n = 0; n < 8; ++n)
      for (int k = 0; k < 4; ++k)
        roots.of[n][k] = {unit_root<size, -1>(2 * k * n), unit_root<size, -1>((2 * k + 1) * n)};
    return roots;
  }

  int lane, warp, along;  ///< of a thread; its place among the eight that share a row
  int row;                ///< where the row of its wave number -- and of its mirror -- begins
  int mirror;
  Complex* memory;
  Roots const* roots;

  GLADSTONE_HD WindowTransform(unsigned thread, Complex* shared, Roots const* shared_roots)
      : lane(static_cast<int>(thread % 32u)),
        warp(static_cast<int>(thread / 32u)),
        along(static_cast<int>(thread % 8u)),
        memory(shared),
        roots(shared_roots) {
    int const q = static_cast<int>(thread / 8u % 4u);
    row = place(warp, q);
    mirror = warp > 0 ? place(8 - warp, 7 - q) : place(0, q > 0 ? 8 - q : 4);
  }

  // ---- along y: a warp takes 32 columns and as many again

  /// @param z columns lane and lane + 32, rows warp + 8 r. A barrier of all threads follows.
  GLADSTONE_HD void columns_apart(Complex (&z)[2][8]) const {
    for (int half = 0; half < 2; ++half) {
      small_transform<8, -1, 1>(z[half]);
      turn<-1>(z[half], warp);
      for (int k = 0; k < 8; ++k) memory[place(k, warp) + lane + 32 * half] = z[half][k];
    }
  }
  /// Columns 2 lane and 2 lane + 1. A barrier of all threads follows.
  GLADSTONE_HD void columns_together() const {
    Complex z[2][8];
    for (int n = 0; n < 8; ++n) {
      ComplexPair const both = pair_at(place(warp, n) + 2 * lane);
      z[0][n] = both.even;
      z[1][n] = both.odd;
    }
    for (Complex(&column)[8] : z) {
      small_transform<8, -1, 1>(column);
      if (warp == 0) {  // so that the sums of rows_apart give 2 (A_0 + i A_32), 2 (B_0 + i B_32)
        Complex const zero = column[0], nyquist = column[4];
        column[0] = {zero.re + zero.im, nyquist.re + nyquist.im};
        column[4] = {zero.re - zero.im, nyquist.im - nyquist.re};
      }
    }
    for (int k = 0; k < 8; ++k) pair_at(place(warp, k) + 2 * lane) = {z[0][k], z[1][k]};
  }

  // ---- along x: eight lanes take a row of a and of b

  /// @param a receives 2 A, @param b 2 i B, first pass done. A barrier of the warp follows.
  GLADSTONE_HD void rows_apart(Complex (&a)[8], Complex (&b)[8]) const {
    for (int r = 0; r < 8; ++r) {
      Complex const d = memory[row + along + 8 * r], m = memory[mirror + along + 8 * r];
      a[r] = {d.re + m.re, d.im - m.im};
      b[r] = {d.re - m.re, d.im + m.im};
    }
    small_transform<8, -1, 1>(a);
    small_transform<8, -1, 1>(b);
    turn<-1>(a, along);
    turn<-1>(b, along);
  }
  /// A barrier of the warp follows.
  GLADSTONE_HD void keep_rows(Complex const (&a)[8], Complex const (&b)[8]) const {
    for (int k = 0; k < 8; ++k) {
      memory[row + 9 * k + along] = a[k];
      memory[mirror + 9 * k + along] = b[k];
    }
  }
  /// The second pass: wave numbers along + 8 k. A barrier of the warp follows.
  GLADSTONE_HD void rows_together(Complex (&a)[8], Complex (&b)[8]) const {
    for (int n = 0; n < 8; ++n) {
      a[n] = memory[row + 9 * along + n];
      b[n] = memory[mirror + 9 * along + n];
    }
    small_transform<8, -1, 1>(a);
    small_transform<8, -1, 1>(b);
  }

  // ---- the cross spectrum; warp 0 has barriers of its own between the steps of its packed row

  /// 4 C = 4 conj(A) B, left in a.
  GLADSTONE_HD static void product(Complex (&a)[8], Complex const (&b)[8]) {
    for (int k = 0; k < 8; ++k) {
      Complex const both = conj(a[k]) * b[k];
      a[k] = {both.im, -both.re};
    }
  }
  GLADSTONE_HD bool has_packed_row() const { return warp == 0; }
  GLADSTONE_HD void keep_packed(Complex const (&a)[8], Complex const (&b)[8]) const {
    if (lane >= 8) return;
    for (int k = 0; k < 8; ++k) {
      memory[row + along + 8 * k] = a[k];
      memory[mirror + along + 8 * k] = b[k];
    }
  }
  GLADSTONE_HD void multiply_packed() const {
    Complex *const p = memory + place(0, 0), *const r = memory + place(0, 4);
    for (int k = lane; k <= size / 2; k += 32) {
      int const other = (size - k) & (size - 1);
      Complex const here = p[k], there = p[other], flow_here = r[k], flow_there = r[other];
      p[k] = packed_product(here, there, flow_here, flow_there);
      p[other] = packed_product(there, here, flow_there, flow_here);
    }
  }
  GLADSTONE_HD void take_packed(Complex (&c)[8]) const {
    if (lane >= 8) return;
    for (int k = 0; k < 8; ++k) c[k] = memory[row + along + 8 * k];
  }

  // ---- back along x

  /// A barrier of the warp follows.
  GLADSTONE_HD void rows_apart_again(Complex (&c)[8]) const {
    small_transform<8, 1, 1>(c);
    turn<1>(c, along);
    for (int k = 0; k < 8; ++k) memory[row + 9 * k + along] = c[k];
  }
  /// Shifts along + 8 k. A barrier of the warp follows.
  GLADSTONE_HD void rows_together_again(Complex (&c)[8]) const {
    for (int n = 0; n < 8; ++n) c[n] = memory[row + 9 * along + n];
    small_transform<8, 1, 1>(c);
  }
  /// A barrier of all threads follows.
  GLADSTONE_HD void keep_shifts(Complex const (&c)[8]) const {
    for (int k = 0; k < 8; ++k) memory[row + along + 8 * k] = c[k];
  }

  // ---- back along y: a warp takes all 32 pairs of columns

  /// From the lower half to the upper one. A barrier of all threads follows.
  GLADSTONE_HD void columns_apart_again() const {
    Complex g[8];
    for (int r = 0; r < 4; ++r) {
      ComplexPair const at = pair_at(place(warp, r) + 2 * lane);
      g[r] = {at.even.re - at.odd.im, at.even.im + at.odd.re};
    }
    int const last = (warp > 0 ? 4 * (8 - warp) + 7 : 8) * pitch + 2 * lane;
    for (int r = 4; r < 8; ++r) {
      ComplexPair const at = pair_at(last - r * pitch);
      g[r] = {at.even.re + at.odd.im, at.odd.re - at.even.im};
    }
    if (has_packed_row()) {
      ComplexPair const at = pair_at(2 * lane);
      g[0] = {at.even.re, at.odd.re};
      g[4] = {at.even.im, at.odd.im};
    }
    small_transform<8, 1, 1>(g);
    turn<1>(g, warp);
    Complex* const out = memory + upper + (warp >> 1) * pitch + (warp & 1) * 32 + lane;
    for (int k = 0; k < 8; ++k) out[4 * k * pitch] = g[k];
  }
  /// From the upper half to the plane: shift (0, 0) at its middle. A barrier of all threads follows.
  GLADSTONE_HD void columns_together_again() const {
    Complex g[8];
    Complex const* const in = memory + upper + 4 * warp * pitch + lane;
    for (int n = 0; n < 8; ++n) g[n] = in[n / 2 * pitch + n % 2 * 32];
    small_transform<8, 1, 1>(g);
    float* const out = plane() + warp * plane_pitch + ((2 * lane + size / 2) & (size - 1));
    for (int k = 0; k < 8; ++k) {  // values of neighbouring columns
      *reinterpret_cast<Complex*>(out + (8 * k + size / 2) % size * plane_pitch) = g[k];
    }
  }
  /// 4 * 64^2 times the correlation, shift (dx, dy) at row dy + 32 and column dx + 32.
  GLADSTONE_HD float* plane() const { return &memory->re; }

 private:
  GLADSTONE_HD static constexpr int place(int p, int q) { return ((q & 4) * 8 + 4 * p + (q & 3)) * pitch; }
  /// Two neighbouring values, the first at an even place.
  GLADSTONE_HD ComplexPair& pair_at(int at) const { return *reinterpret_cast<ComplexPair*>(memory + at); }

  /// Turns value k by exp(sign 2 pi i n k / 64).
  template <int sign>
  GLADSTONE_HD void turn(Complex (&z)[8], int n) const {
    for (int k = 0; k < 4; ++k) {
      ComplexPair const pair = roots->of[n][k];
      if (k > 0) z[2 * k] = z[2 * k] * (sign < 0 ? pair.even : conj(pair.even));
      z[2 * k + 1] = z[2 * k + 1] * (sign < 0 ? pair.odd : conj(pair.odd));
    }
  }
};

}  // namespace gladstone::cuda
