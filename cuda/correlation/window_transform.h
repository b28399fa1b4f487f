#pragma once

#include "cuda/correlation/paired_plane.h"

/// The correlation plane of a window of 64 x 64 values by 256 threads, which hold sixteen values each and exchange them
/// through memory that they share. A line of 64 takes two passes of eight values, 64 = 8 x 8, and all passes are short.
///
/// With a and b the windows, z = a + i b and tilde a transform along y, the steps below
///  1. transform columns of z along y (columns_apart, columns_together);
///  2. take rows k < 32 of the spectra of a and of b out of rows k and -k, and transform along x (rows_apart,
///     rows_together); rows 0 and 32, both of real columns, share a place as real and imaginary part;
///  3. form conj(A) B and transform back along x (product, rows_apart_again, rows_together_again);
///  4. transform columns 2 x and 2 x + 1 of the plane, joined as a complex number, back along y, as many of them as the
///     search for peaks reads (columns_apart_again, columns_together_again, keep_plane).
/// A step is what one thread does between two barriers; the comments say which: all steps of the rows of one warp stay
/// within it, and so do those of the columns of step 4. No two threads write, nor one writes and another reads, the
/// same place between two barriers.
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
  static constexpr int upper = 32 * pitch;         ///< where the upper half begins
  static constexpr int plane_pitch = 73;           ///< of the plane, in the upper half; odd for SearchBlock
  static constexpr int largest_radius = size / 4;  ///< of shifts; all are right up to one more

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

  int thread;  ///< what follows from it is cheaper to reckon again than to keep in registers
  Complex* memory;
  Roots const* roots;

  GLADSTONE_HD WindowTransform(unsigned number, Complex* shared, Roots const* shared_roots)
      : thread(static_cast<int>(number)), memory(shared), roots(shared_roots) {}
  GLADSTONE_HD int lane() const { return thread & 31; }
  GLADSTONE_HD int warp() const { return thread >> 5; }
  GLADSTONE_HD int along() const { return thread & 7; }  ///< its place among the eight that share a row
  /// Where the row of its wave number -- and of its mirror -- begins.
  GLADSTONE_HD int row() const { return (thread >> 3) * pitch; }
  GLADSTONE_HD int mirror() const {
    int const line = thread >> 3;  // 4 p + q
    return (warp() > 0 ? 67 - line : 32 + (-line & 3)) * pitch;
  }

  // ---- along y: a warp takes 32 columns and as many again

  /// @param z columns lane and lane + 32, rows warp + 8 r. A barrier of all threads follows.
  GLADSTONE_HD void columns_apart(Complex (&z)[2][8]) const {
    for (int half = 0; half < 2; ++half) {
      small_transform<8, -1, 1>(z[half]);
      turn<-1>(z[half], warp());
      for (int k = 0; k < 8; ++k) memory[place(k, warp()) + lane() + 32 * half] = z[half][k];
    }
  }
  /// Columns 2 lane and 2 lane + 1. A barrier of all threads follows.
  GLADSTONE_HD void columns_together() const {
    Complex z[2][8];
    for (int n = 0; n < 8; ++n) {
      ComplexPair const both = pair_at(place(warp(), n) + 2 * lane());
      z[0][n] = both.even;
      z[1][n] = both.odd;
    }
    for (Complex(&column)[8] : z) {
      small_transform<8, -1, 1>(column);
      if (warp() == 0) {  // so that the sums of rows_apart give 2 (A_0 + i A_32), 2 (B_0 + i B_32)
        Complex const zero = column[0], nyquist = column[4];
        column[0] = {zero.re + zero.im, nyquist.re + nyquist.im};
        column[4] = {zero.re - zero.im, nyquist.im - nyquist.re};
      }
    }
    for (int k = 0; k < 8; ++k) pair_at(place(warp(), k) + 2 * lane()) = {z[0][k], z[1][k]};
  }

  // ---- along x: eight lanes take a row of a and of b

  /// @param a receives 2 A, @param b 2 i B, first pass done. A barrier of the warp follows.
  GLADSTONE_HD void rows_apart(Complex (&a)[8], Complex (&b)[8]) const {
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
  /// A barrier of the warp follows.
  GLADSTONE_HD void keep_rows(Complex const (&a)[8], Complex const (&b)[8]) const {
    for (int k = 0; k < 8; ++k) {
      memory[row() + 9 * k + along()] = a[k];
      memory[mirror() + 9 * k + along()] = b[k];
    }
  }
  /// The second pass: wave numbers along + 8 k. A barrier of the warp follows.
  GLADSTONE_HD void rows_together(Complex (&a)[8], Complex (&b)[8]) const {
    for (int n = 0; n < 8; ++n) {
      a[n] = memory[row() + 9 * along() + n];
      b[n] = memory[mirror() + 9 * along() + n];
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

  // ---- back along x

  /// A barrier of the warp follows.
  GLADSTONE_HD void rows_apart_again(Complex (&c)[8]) const {
    small_transform<8, 1, 1>(c);
    turn<1>(c, along());
    for (int k = 0; k < 8; ++k) memory[row() + 9 * k + along()] = c[k];
  }
  /// Shifts along + 8 k. A barrier of the warp follows.
  GLADSTONE_HD void rows_together_again(Complex (&c)[8]) const {
    for (int n = 0; n < 8; ++n) c[n] = memory[row() + 9 * along() + n];
    small_transform<8, 1, 1>(c);
  }
  /// Shifts from -24 to 23. Those of wave number p + 8 q along y begin 2 p places on in their row, so that the lanes
  /// that take a pair of columns, a lane a p, read from different banks. A barrier of all threads follows.
  GLADSTONE_HD void keep_shifts(Complex const (&c)[8]) const {
    for (int k = 0; k < 8; ++k)
      if (is_kept(k)) memory[row() + 2 * warp() + along() + kept_place(k)] = c[k];
  }

  // ---- back along y: eight lanes take a pair of columns, a warp four, for shifts up to radius + 1 and a few more

  /// Whether a warp has pairs of columns.
  GLADSTONE_HD bool has_columns(int radius) const { return 4 * warp() < radius + 2; }
  /// From the lower half to the upper one. A barrier of the warp follows.
  GLADSTONE_HD void columns_apart_again(int radius) const {
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
  /// @param g receives shifts along + 8 k. A barrier of the warp follows.
  GLADSTONE_HD void columns_together_again(Complex (&g)[8]) const {
    Complex const* const in = exchange() + 9 * along();
    for (int n = 0; n < 8; ++n) g[n] = in[n];
    small_transform<8, 1, 1>(g);
  }
  /// A barrier of all threads follows.
  GLADSTONE_HD void keep_plane(Complex const (&g)[8]) const {
    Complex* const out = memory + upper + own_pair() * plane_pitch + along();
    for (int k = 0; k < 8; ++k)
      if (is_kept(k)) out[kept_place(k)] = g[k];
  }
  /// 4 * 64^2 times the correlation at shifts up to radius + 1 along either axis.
  GLADSTONE_HD PairedPlane<plane_pitch> plane(int radius) const {
    return {memory + upper + middle_pair(radius) * plane_pitch + kept_place(0)};
  }

 private:
  GLADSTONE_HD static constexpr int place(int p, int q) { return ((q & 4) * 8 + 4 * p + (q & 3)) * pitch; }
  /// Whether shifts 8 k to 8 k + 7 are, modulo 64, among those from -24 to 23 that are kept, and where they begin.
  GLADSTONE_HD static constexpr bool is_kept(int k) { return k < 3 || k > 4; }
  GLADSTONE_HD static constexpr int kept_place(int k) { return (8 * k + 24) % size; }
  /// Pairs of columns are counted from the leftmost that the search reads; this is that of shifts 0 and 1.
  GLADSTONE_HD static constexpr int middle_pair(int radius) { return radius / 2 + 1; }
  GLADSTONE_HD int own_pair() const { return 4 * warp() + lane() / 8; }
  /// Where the eight lanes of a pair exchange values: within their warp's part of the plane.
  GLADSTONE_HD Complex* exchange() const { return memory + upper + 4 * warp() * plane_pitch + lane() / 8 * pitch; }
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
