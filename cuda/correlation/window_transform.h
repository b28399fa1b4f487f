#pragma once

#include "cuda/correlation/paired_plane.h"

/// Correlation plane of a window of 64 x 64 values by 256 threads, each of which holds sixteen values and exchanges
/// them through shared memory. A transform of 64 values takes two short passes of eight values, 64 = 8 x 8.
///
/// With a and b the windows, z = a + i b, and tilde a transform along y, the steps are:
///  1. transform columns of z along y (column_first_pass, column_second_pass);
///  2. extract rows k < 32 of the spectra of a and b from rows k and -k, and transform along x (row_first_pass,
///     row_second_pass); rows 0 and 32, whose columns are real, share a row as real and imaginary part;
///  3. form conj(A) B and transform back along x (product, inverse_row_first_pass, inverse_row_second_pass);
///  4. transform columns 2 x and 2 x + 1 of the plane, joined as complex numbers, back along y, for those columns
///     only that the peak search reads (inverse_column_first_pass, inverse_column_second_pass, keep_plane).
/// A step is the work of one thread between two barriers, which are given in the comments. The rows of a warp in steps
/// 2 and 3 and its columns in step 4 are exchanged within the warp only. Between barriers, no two threads access the
/// same memory unless both only read.
///
/// Wave number or shift p + 8 q of a column is in row 4 p + q % 4 of the lower (q < 4) or upper half of the memory. The
/// second pass of a column thus writes where it reads. Half-warps, which process rows q and q + 1, access all banks,
/// since the row length is an odd multiple of eight values.
namespace gladstone::cuda::inline correlation {

struct WindowTransform {
  static constexpr int size = 64;
  static constexpr int threads = 256;
  static constexpr int pitch = 72;
  static constexpr int values = size * pitch;
  static constexpr int upper = 32 * pitch;         ///< offset of the upper half of the memory
  static constexpr int plane_pitch = 73;           ///< row stride of the plane in the upper half; odd for SearchBlock
  static constexpr int largest_radius = size / 4;  ///< largest search radius; shifts up to one more are valid

  struct alignas(16) ComplexPair {
    Complex even, odd;
  };
  /// exp(-2 pi i n k / 64), k = 0 .. 7, in row n; the row length puts eight rows into different banks.
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

  int thread;  ///< index of the thread; values derived from it are recomputed, which is cheaper than registers
  Complex* memory;
  Roots const* roots;

  GLADSTONE_HD WindowTransform(unsigned number, Complex* shared, Roots const* shared_roots)
      : thread(static_cast<int>(number)), memory(shared), roots(shared_roots) {}
  GLADSTONE_HD int lane() const { return thread & 31; }
  GLADSTONE_HD int warp() const { return thread >> 5; }
  GLADSTONE_HD int along() const { return thread & 7; }  ///< index of the thread among the eight that share a row
  /// Offset of the row of this thread's wave number, and of the row of the mirrored wave number.
  GLADSTONE_HD int row() const { return (thread >> 3) * pitch; }
  GLADSTONE_HD int mirror() const {
    int const line = thread >> 3;  // equals 4 p + q, see the layout above
    return (warp() > 0 ? 67 - line : 32 + (-line & 3)) * pitch;
  }

  // ---- along y: each warp processes columns lane and lane + 32

  /// First pass. @param z  columns lane and lane + 32, rows warp + 8 r. Must be followed by a barrier of all threads.
  GLADSTONE_HD void column_first_pass(Complex (&z)[2][8]) const {
    for (int half = 0; half < 2; ++half) {
      small_transform<8, -1, 1>(z[half]);
      turn<-1>(z[half], warp());
      for (int k = 0; k < 8; ++k) memory[place(k, warp()) + lane() + 32 * half] = z[half][k];
    }
  }
  /// Second pass, columns 2 lane and 2 lane + 1. Must be followed by a barrier of all threads.
  GLADSTONE_HD void column_second_pass() const {
    Complex z[2][8];
    for (int n = 0; n < 8; ++n) {
      ComplexPair const both = pair_at(place(warp(), n) + 2 * lane());
      z[0][n] = both.even;
      z[1][n] = both.odd;
    }
    for (Complex(&column)[8] : z) {
      small_transform<8, -1, 1>(column);
      if (warp() == 0) {  // combine the columns so that the sums in row_first_pass() give 2 (A_0 + i A_32) and 2 (B_0 +
                          // i B_32)
        Complex const zero = column[0], nyquist = column[4];
        column[0] = {zero.re + zero.im, nyquist.re + nyquist.im};
        column[4] = {zero.re - zero.im, nyquist.im - nyquist.re};
      }
    }
    for (int k = 0; k < 8; ++k) pair_at(place(warp(), k) + 2 * lane()) = {z[0][k], z[1][k]};
  }

  // ---- along x: eight lanes process a row of a and of b

  /// First pass. @param a, b  output: 2 A and 2 i B after the first pass. Must be followed by a barrier of the warp.
  GLADSTONE_HD void row_first_pass(Complex (&a)[8], Complex (&b)[8]) const {
    for (int r = 0; r < 8; ++r) {
      Complex const d = memory[row() + along() + 8 * r], m = memory[mirror() + along() + 8 * r];
      a[r] = {d.re + m.re, d.im - m.im};
      b[r] = {d.re - m.re, d.im + m.im};
    }
    small_transform<8, -1, 1>(a);
    small_transform<8, -1, 1>(b);
    turn<-1>(a, along());
    turn<-1>(b, along());
  }
  /// Writes the rows of both spectra. Must be followed by a barrier of the warp.
  GLADSTONE_HD void keep_rows(Complex const (&a)[8], Complex const (&b)[8]) const {
    for (int k = 0; k < 8; ++k) {
      memory[row() + 9 * k + along()] = a[k];
      memory[mirror() + 9 * k + along()] = b[k];
    }
  }
  /// Second pass. Value k of the thread is then wave number along() + 8 k. Must be followed by a barrier of the warp.
  GLADSTONE_HD void row_second_pass(Complex (&a)[8], Complex (&b)[8]) const {
    for (int n = 0; n < 8; ++n) {
      a[n] = memory[row() + 9 * along() + n];
      b[n] = memory[mirror() + 9 * along() + n];
    }
    small_transform<8, -1, 1>(a);
    small_transform<8, -1, 1>(b);
  }

  // ---- cross spectrum; the packed row of warp 0 requires additional barriers between the steps

  /// Replaces a by 4 C = 4 conj(A) B.
  GLADSTONE_HD static void product(Complex (&a)[8], Complex const (&b)[8]) {
    for (int k = 0; k < 8; ++k) {
      Complex const both = conj(a[k]) * b[k];
      a[k] = {both.im, -both.re};
    }
  }
  GLADSTONE_HD bool has_packed_row() const { return warp() == 0; }
  GLADSTONE_HD void keep_packed(Complex const (&a)[8], Complex const (&b)[8]) const {
    if (lane() >= 8) return;
    for (int k = 0; k < 8; ++k) {
      memory[row() + along() + 8 * k] = a[k];
      memory[mirror() + along() + 8 * k] = b[k];
    }
  }
  GLADSTONE_HD void multiply_packed() const {
    Complex *const p = memory + place(0, 0), *const r = memory + place(0, 4);
    for (int k = lane(); k <= size / 2; k += 32) {
      int const other = (size - k) & (size - 1);
      Complex const here = p[k], there = p[other], flow_here = r[k], flow_there = r[other];
      p[k] = packed_product(here, there, flow_here, flow_there);
      p[other] = packed_product(there, here, flow_there, flow_here);
    }
  }
  GLADSTONE_HD void take_packed(Complex (&c)[8]) const {
    if (lane() >= 8) return;
    for (int k = 0; k < 8; ++k) c[k] = memory[row() + along() + 8 * k];
  }

  // ---- inverse transform along x

  /// First pass. Must be followed by a barrier of the warp.
  GLADSTONE_HD void inverse_row_first_pass(Complex (&c)[8]) const {
    small_transform<8, 1, 1>(c);
    turn<1>(c, along());
    for (int k = 0; k < 8; ++k) memory[row() + 9 * k + along()] = c[k];
  }
  /// Second pass. Value k of the thread is then shift along() + 8 k. Must be followed by a barrier of the warp.
  GLADSTONE_HD void inverse_row_second_pass(Complex (&c)[8]) const {
    for (int n = 0; n < 8; ++n) c[n] = memory[row() + 9 * along() + n];
    small_transform<8, 1, 1>(c);
  }
  /// Writes shifts from -24 to 23. Rows of wave numbers p + 8 q along y start at an offset of 2 p, so that the lanes of
  /// a pair of columns, one per p, read from different banks. Must be followed by a barrier of all threads.
  GLADSTONE_HD void keep_shifts(Complex const (&c)[8]) const {
    for (int k = 0; k < 8; ++k)
      if (is_kept(k)) memory[row() + 2 * warp() + along() + kept_place(k)] = c[k];
  }

  // ---- inverse transform along y: eight lanes process a pair of columns, a warp four pairs, for shifts of at least
  // radius + 1

  /// Returns whether this warp has pairs of columns.
  GLADSTONE_HD bool has_columns(int radius) const { return 4 * warp() < radius + 2; }
  /// First pass, from the lower half to the upper half. Must be followed by a barrier of the warp.
  GLADSTONE_HD void inverse_column_first_pass(int radius) const {
    int const x = kept_place(0) + 2 * (own_pair() - middle_pair(radius));
    int const near = place(along(), 0) + 2 * along() + x;
    int const opposite = -along() & 7, far = place(opposite, 3) + 2 * opposite + x;
    Complex g[8], mirrored[4];
    for (int r = 0; r < 4; ++r) {
      ComplexPair const at = pair_at(near + r * pitch), back = pair_at(far - r * pitch);
      g[r] = {at.even.re - at.odd.im, at.even.im + at.odd.re};
      mirrored[r] = {back.even.re + back.odd.im, back.odd.re - back.even.im};
    }
    bool const packed = along() == 0;  // the mirror of row 8 r is 64 - 8 r, that of p + 8 r is 8 - p + 8 (7 - r)
    ComplexPair const first = pair_at(near);
    if (packed) g[0] = {first.even.re, first.odd.re};
    g[4] = packed ? Complex{first.even.im, first.odd.im} : mirrored[0];
    for (int r = 1; r < 4; ++r) g[4 + r] = packed ? mirrored[r - 1] : mirrored[r];
    small_transform<8, 1, 1>(g);
    turn<1>(g, along());
    Complex* const out = exchange() + along();
    for (int k = 0; k < 8; ++k) out[9 * k] = g[k];
  }
  /// Second pass. Must be followed by a barrier of the warp.
  /// @param g  output: value k is that at shift along() + 8 k
  GLADSTONE_HD void inverse_column_second_pass(Complex (&g)[8]) const {
    Complex const* const in = exchange() + 9 * along();
    for (int n = 0; n < 8; ++n) g[n] = in[n];
    small_transform<8, 1, 1>(g);
  }
  /// Writes the plane. Must be followed by a barrier of all threads.
  GLADSTONE_HD void keep_plane(Complex const (&g)[8]) const {
    Complex* const out = memory + upper + own_pair() * plane_pitch + along();
    for (int k = 0; k < 8; ++k)
      if (is_kept(k)) out[kept_place(k)] = g[k];
  }
  /// Returns the plane, which is 4 * 64^2 times the correlation, for shifts up to radius + 1 along either axis.
  GLADSTONE_HD PairedPlane<plane_pitch> plane(int radius) const {
    return {memory + upper + middle_pair(radius) * plane_pitch + kept_place(0)};
  }

 private:
  GLADSTONE_HD static constexpr int place(int p, int q) { return ((q & 4) * 8 + 4 * p + (q & 3)) * pitch; }
  /// is_kept() returns whether shifts 8 k to 8 k + 7 (modulo 64) are in the stored range -24 to 23; kept_place()
  /// returns the offset of the first of them.
  GLADSTONE_HD static constexpr bool is_kept(int k) { return k < 3 || k > 4; }
  GLADSTONE_HD static constexpr int kept_place(int k) { return (8 * k + 24) % size; }
  /// Index of the pair of shifts 0 and 1; pairs of columns are counted from the leftmost that the search reads.
  GLADSTONE_HD static constexpr int middle_pair(int radius) { return radius / 2 + 1; }
  GLADSTONE_HD int own_pair() const { return 4 * warp() + lane() / 8; }
  /// Buffer for the exchange between the eight lanes of a pair, within their warp's part of the plane.
  GLADSTONE_HD Complex* exchange() const { return memory + upper + 4 * warp() * plane_pitch + lane() / 8 * pitch; }
  /// Two adjacent values, the first at an even index.
  GLADSTONE_HD ComplexPair& pair_at(int at) const { return *reinterpret_cast<ComplexPair*>(memory + at); }

  /// Multiplies value k by exp(sign 2 pi i n k / 64).
  template <int sign>
  GLADSTONE_HD void turn(Complex (&z)[8], int n) const {
    for (int k = 0; k < 4; ++k) {
      ComplexPair const pair = roots->of[n][k];
      if (k > 0) z[2 * k] = z[2 * k] * (sign < 0 ? pair.even : conj(pair.even));
      z[2 * k + 1] = z[2 * k + 1] * (sign < 0 ? pair.odd : conj(pair.odd));
    }
  }
};

}  // namespace gladstone::cuda::inline correlation
