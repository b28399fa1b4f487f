#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/host_device.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {

/// Pseudo-degree that selects a windowed sinc over eight pixels instead of a B-spline; its coefficients are the pixels.
inline constexpr int windowed_sinc = 7;

/// Computes the weights of the degree + 1 B-splines that are non-zero at a distance t after a node, 0 <= t < 1, from
/// left to right. Unser, Aldroubi & Eden, IEEE Trans. Signal Process. 41 (1993) 821, Eq. 2.3, expanded in powers of t.
/// @tparam T  a number or a SIMD vector of numbers
/// @tparam Number  element type of T
template <int degree, class T, class Number = T>
GLADSTONE_HD void bspline_weights(T t, T* w) {
  static_assert(degree == 3 || degree == 5);
  using N = Number;
  T const s = N(1) - t;
  T const t2 = t * t;
  if constexpr (degree == 3) {
    w[0] = s * s * s / N(6);
    w[1] = (N(4) + t2 * (N(3) * t - N(6))) / N(6);
    w[2] = (N(1) + t * (N(3) + t * (N(3) - N(3) * t))) / N(6);
    w[3] = t2 * t / N(6);
  } else {
    N const c = N(1) / N(120);
    w[0] = c * s * s * s * s * s;
    w[1] = c * (N(26) + t * (N(-50) + t * (N(20) + t * (N(20) + t * (N(-20) + N(5) * t)))));
    w[2] = c * (N(66) + t2 * (N(-60) + t2 * (N(30) - N(10) * t)));
    w[3] = c * (N(26) + t * (N(50) + t * (N(20) + t * (N(-20) + t * (N(-20) + N(10) * t)))));
    w[4] = c * (N(1) + t * (N(5) + t * (N(10) + t * (N(10) + t * (N(5) - N(5) * t)))));
    w[5] = c * t2 * t2 * t;
  }
}

/// sin(pi d)/(pi d) for |d| <= 1 by its series, with an error of 1e-8. @tparam T, Number as in bspline_weights()
template <class T, class Number = T>
GLADSTONE_HD T sinc_near_zero(T d) {
  constexpr Number pi2 = Number(9.8696044010893586);
  T const x2 = pi2 * d * d;
  T sum = T{} + Number(1);
  for (int n = 9; n >= 1; --n) sum = Number(1) - x2 / Number(2 * n * (2 * n + 1)) * sum;
  return sum;
}

/// Computes the weights of eight pixels at a distance t after the fourth of them, 0 <= t < 1: a sinc multiplied by a
/// sinc of four times its width (Lanczos window; Duchon, J. Appl. Meteorol. 18 (1979) 1016), normalised so that
/// constants are reproduced.
template <class T, class Number = T>
GLADSTONE_HD void windowed_sinc_weights(T t, T* w) {
  using N = Number;
  constexpr N half_turn = N(3.14159265358979324);
  // sin(pi (t - k)) equals sin(pi t) with the sign of the parity of k.
  T const sine = half_turn * t * sinc_near_zero<T, N>(t);
  T sum{};
  for (int i = 0; i < 8; ++i) {
    T const d = t - N(i - 3);
    T const window = sinc_near_zero<T, N>(N(0.25) * d);
    if (i == 3 || i == 4)
      w[i] = sinc_near_zero<T, N>(d) * window;
    else
      w[i] = ((i - 3) % 2 == 0 ? N(1) : N(-1)) * sine / (half_turn * d) * window;
    sum += w[i];
  }
  for (int i = 0; i < 8; ++i) w[i] = w[i] / sum;
}

/// Computes the weights of the degree + 1 coefficients at a distance t after a node, from left to right: B-splines, or
/// the windowed sinc for degree 7.
template <int degree, class T, class Number = T>
GLADSTONE_HD void interpolation_weights(T t, T* w) {
  if constexpr (degree == windowed_sinc)
    windowed_sinc_weights<T, Number>(t, w);
  else
    bspline_weights<degree, T, Number>(t, w);
}

/// Returns the index of the pixel that is found at index i after reflection at the centres of the outermost pixels.
GLADSTONE_HD inline int mirrored_index(int i, int count) {
  if (i >= 0 && i < count) return i;
  if (count == 1) return 0;
  int const period = 2 * (count - 1);
  int const k = (i < 0 ? -i : i) % period;
  return k < count ? k : period - k;
}

/// Returns the poles of the recursive filter that converts samples to B-spline coefficients, Unser et al. (1993), Table
/// 1.
/// @param degree  3 or 5; no poles for windowed_sinc
inline std::vector<double> bspline_poles(int degree) {
  if (degree == windowed_sinc) return {};
  if (degree == 3) return {-0.26794919243112270647};  // sqrt(3) - 2
  return {-0.43057534709997377, -0.04309628820326465};
}

/// Returns the filter of bspline_poles() as a symmetric convolution, for devices where recursion is slow: coefficient i
/// is the sum over k of tap |k| times sample i + k.
/// @return taps from k = 0 on; taps below 1e-10 of the first one are omitted, since they are below the float resolution
inline std::vector<double> bspline_taps(int degree) {
  constexpr int most = 48;
  std::vector<double> taps(most, 0.0);
  taps[0] = 1.0;
  for (double const z : bspline_poles(degree)) {
    // Each pole z has the impulse response gain z^|k|, normalised to a sum of 1.
    double const gain = (1.0 - z) / (1.0 + z);
    std::vector<double> next(most, 0.0);
    for (int k = 0; k < most; ++k)
      for (int m = -most + 1; m < most; ++m) next[k] += gain * std::pow(z, std::abs(k - m)) * taps[std::abs(m)];
    taps = next;
  }
  while (std::abs(taps.back()) < 1e-10 * taps.front()) taps.pop_back();
  return taps;
}

/// Non-owning view of B-spline coefficients with a margin of mirrored coefficients around the image, so that evaluation
/// needs no border test.
template <class T>
struct BsplineView {
  static constexpr int margin_before = 4;  ///< columns and rows before pixel 0
  static constexpr int margin_after = 8;   ///< columns and rows after the last pixel
  /// Number of coefficients read per row: degree + 1 rounded up to 8; the weights of the additional ones are 0.
  static constexpr int lanes = 8;

  T const* coefficients;
  int stride;
  int columns;
  int rows;

  /// Evaluates the spline at (column + dx, row + dy) [px]. The pixel and the offset are separate arguments, so that
  /// float coordinates remain exact on large images. Positions more than a pixel outside the image are moved back to
  /// its edge.
  template <int degree>
  GLADSTONE_HD T sample(int column, int row, T dx, T dy) const {
    using std::floor;
    T const floor_x = floor(dx), floor_y = floor(dy);
    int const base_x = clamp(column + static_cast<int>(floor_x), columns);
    int const base_y = clamp(row + static_cast<int>(floor_y), rows);
    T weight_x[lanes] = {}, weight_y[degree + 1];
    interpolation_weights<degree>(dx - floor_x, weight_x);
    interpolation_weights<degree>(dy - floor_y, weight_y);
    constexpr int before = (degree - 1) / 2;
    T const* c = coefficients + static_cast<long long>(base_y - before + margin_before) * stride +
                 (base_x - before + margin_before);
    T sum[lanes] = {};
    for (int j = 0; j <= degree; ++j, c += stride)
      for (int i = 0; i < lanes; ++i) sum[i] += weight_y[j] * c[i];
    for (int i = 0; i < lanes; ++i) sum[i] *= weight_x[i];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
  }

  /// Clamps the first pixel of an interval to at most one pixel outside the image.
  GLADSTONE_HD static int clamp(int base, int count) { return base < -1 ? -1 : (base > count - 1 ? count - 1 : base); }
};

/// Image as an interpolating B-spline: it passes through every pixel and has degree - 1 continuous derivatives. The
/// image is continued by reflection at the centres of its outermost pixels. The coefficients follow from the recursive
/// filter of Unser et al. (1993), Eqs. 3.5 to 3.9. Away from the border, the spline reproduces polynomials up to its
/// degree.
template <class T>
class BsplineImage {
 public:
  /// @param pixel  value at (column, row), called once for each pixel
  /// @param degree  3, 5 or windowed_sinc
  template <class Pixel>
  BsplineImage(int columns, int rows, int degree, Pixel const& pixel)
      : columns_(columns), rows_(rows), stride_(columns + View::margin_before + View::margin_after) {
    GLADSTONE_EXPECTS(columns > 0 && rows > 0 && (degree == 3 || degree == 5 || degree == windowed_sinc));
    coefficients_.resize(static_cast<std::size_t>(stride_) * (rows + View::margin_before + View::margin_after));
    filter_rows(degree, pixel);
    filter_columns(degree);
    mirror_rows();
  }

  using View = BsplineView<T>;
  View view() const { return {coefficients_.data(), stride_, columns_, rows_}; }

 private:
  static constexpr int block = 8;  // number of lines filtered together

  T* row(int j) { return coefficients_.data() + static_cast<std::size_t>(j + View::margin_before) * stride_; }

  /// Returns the gain of the filter. The samples must be multiplied by this gain before filter_lines(), which does not
  /// apply it.
  /// @param count  number of samples in a line
  static double filter_gain(int count, int degree) {
    double gain = 1.0;
    if (count > 1)
      for (double const z : bspline_poles(degree)) gain *= (1.0 - z) * (1.0 - 1.0 / z);
    return gain;
  }

  /// Converts `count` samples, multiplied by filter_gain(), of `block` interleaved lines to coefficients.
  static void filter_lines(double* c, int count, int degree) {
    if (count == 1) return;
    for (double const z : bspline_poles(degree)) {
      // First causal coefficient: sum over the reflected signal until z^k is below rounding.
      int const horizon = static_cast<int>(std::ceil(std::log(1e-17) / std::log(std::abs(z))));
      for (int l = 0; l < block; ++l) {
        double sum = 0.0, power = 1.0;
        for (int k = 0; k < horizon; ++k, power *= z) sum += power * c[mirrored_index(k, count) * block + l];
        c[l] = sum;
      }
      for (int i = 1; i < count; ++i)
        for (int l = 0; l < block; ++l) c[i * block + l] += z * c[(i - 1) * block + l];
      double* last = c + (count - 1) * block;
      for (int l = 0; l < block; ++l) last[l] = z / (z * z - 1.0) * (last[l] + z * last[l - block]);
      for (int i = count - 2; i >= 0; --i)
        for (int l = 0; l < block; ++l) c[i * block + l] = z * (c[(i + 1) * block + l] - c[i * block + l]);
    }
  }

  template <class Pixel>
  void filter_rows(int degree, Pixel const& pixel) {
    double const gain = filter_gain(columns_, degree);
    parallel_chunks(static_cast<std::size_t>(rows_), block, [&](std::size_t begin, std::size_t end) {
      int const first = static_cast<int>(begin), used = static_cast<int>(end - begin);
      std::vector<double> lines(static_cast<std::size_t>(columns_) * block);
      for (int l = 0; l < used; ++l)
        for (int i = 0; i < columns_; ++i) lines[static_cast<std::size_t>(i) * block + l] = gain * pixel(i, first + l);
      filter_lines(lines.data(), columns_, degree);
      for (int l = 0; l < used; ++l) {
        T* const out = row(first + l) + View::margin_before;
        for (int i = 0; i < columns_; ++i) out[i] = static_cast<T>(lines[static_cast<std::size_t>(i) * block + l]);
        for (int i = -View::margin_before; i < 0; ++i) out[i] = out[mirrored_index(i, columns_)];
        for (int i = columns_; i < columns_ + View::margin_after; ++i) out[i] = out[mirrored_index(i, columns_)];
      }
    });
  }

  void filter_columns(int degree) {
    double const gain = filter_gain(rows_, degree);
    parallel_chunks(static_cast<std::size_t>(stride_), block, [&](std::size_t begin, std::size_t end) {
      std::size_t const used = end - begin;
      std::vector<double> lines(static_cast<std::size_t>(rows_) * block);
      for (int j = 0; j < rows_; ++j) {
        T const* const from = row(j) + begin;
        double* const to = lines.data() + static_cast<std::size_t>(j) * block;
        for (std::size_t l = 0; l < used; ++l) to[l] = gain * from[l];
      }
      filter_lines(lines.data(), rows_, degree);
      for (int j = 0; j < rows_; ++j) {
        T* const to = row(j) + begin;
        double const* const from = lines.data() + static_cast<std::size_t>(j) * block;
        for (std::size_t l = 0; l < used; ++l) to[l] = static_cast<T>(from[l]);
      }
    });
  }

  void mirror_rows() {
    for (int j = -View::margin_before; j < rows_ + View::margin_after; ++j)
      if (j < 0 || j >= rows_) std::copy_n(row(mirrored_index(j, rows_)), stride_, row(j));
  }

  int columns_;
  int rows_;
  int stride_;
  std::vector<T> coefficients_;
};

}  // namespace gladstone::inline correlation
