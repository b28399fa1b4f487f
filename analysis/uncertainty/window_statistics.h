#pragma once

#include <cmath>
#include <limits>

#include "analysis/correlation/window_ops.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

/// Sums over one window of matched frames for the displacement variance by correlation statistics. They are computed by
/// cooperating threads: one thread with eight pixel columns at a time on the CPU, threads of a block with one column
/// each in CUDA.
namespace gladstone::inline uncertainty {

/// Access policy of WindowStatistics for one column at a time.
struct OneColumn {
  using Value = float;
  static constexpr int count = 1;
  GLADSTONE_HD static float load(float const* from) { return *from; }
  GLADSTONE_HD static void store(float* to, float value) { *to = value; }
  GLADSTONE_HD static double sum(float value) { return static_cast<double>(value); }
};

/// Pixels of both frames in one row, for one or several columns.
template <class Value>
struct MatchedPixels {
  /// Weight that the correlator applies to each frame; 0 if the pixel is unknown in one of the frames.
  Value weight;
  Value reference;  ///< grey levels of frame A, always finite
  Value flow;
};

/// Weighted means and relative brightness of the two frames in a window. Their effects are removed before the sums are
/// computed.
struct WindowLevels {
  float reference = 0.0f;  ///< weighted mean of frame A
  float flow = 0.0f;
  float flow_gain = 1.0f;  ///< factor that gives the mean-free frame B the same weighted sum of squares as frame A
};

GLADSTONE_HD inline WindowLevels weighted_means(WindowSums<double> const& sums) {
  return {static_cast<float>(sums.reference / sums.weight), static_cast<float>(sums.flow / sums.weight), 1.0f};
}

/// Returns the levels with the gain of frame B. @param squares  weighted sums of squares of frames A (x) and B (y)
GLADSTONE_HD inline WindowLevels equally_bright(WindowLevels levels, Vec2d squares) {
  using std::sqrt;
  if (squares.y > 0.0) levels.flow_gain = static_cast<float>(sqrt(squares.x / squares.y));
  return levels;
}

/// Sums over a window with the frames A = w a and B = w b, which are mean-free, equally bright and weighted. With s = a
/// + b, d = b - a and q = A + B, the terms of the difference between the correlation on both sides of the peak are t_i
/// = w_i d_i (q_(i-1) - q_(i+1))/2, and the factor of the frames' noise in each term is p_i = w_i (q_(i-1) -
/// q_(i+1))/2. Arrays contain the values for the x and y axes.
struct StatisticsSums {
  double centre{};      ///< sum of A B
  double whole{};       ///< sum of w^2
  double beside[2]{};   ///< sum of (A_i B_(i+1) + A_(i+1) B_i)/2
  double overlap[2]{};  ///< sum of w_i w_(i+1)
  double shares[2]{};   ///< sum of p^2
  double lost[2]{};     ///< sum of p_i^2 p_k^2 over neighbours, see WindowStatistics
  double terms[2]{};    ///< sum of t_i t_k over neighbours, see WindowStatistics
  double squares[2]{};  ///< sum of t^2

  static constexpr int count = 14;
  /// Calls visit(sum) for each sum, in a fixed order.
  template <class Visit>
  GLADSTONE_HD void each(Visit const& visit) {
    visit(centre);
    visit(whole);
    for (int axis = 0; axis < 2; ++axis) {
      visit(beside[axis]);
      visit(overlap[axis]);
      visit(shares[axis]);
      visit(lost[axis]);
      visit(terms[axis]);
      visit(squares[axis]);
    }
  }
};

/// Contribution of one thread to the sums over a window. All threads must make the following calls in this order, with
/// a barrier after each call. Between barriers, no two threads access the same memory unless both only read it:
/// 1. clear() and sum_pixels(), whose totals over all threads yield the means;
/// 2. sum_squares(), whose totals over all threads yield the gain of frame B;
///  3. step(n) for n = 0 .. steps(side) - 1.
/// Row n is weighted in step n, its terms are formed in step n + 2, when the rows above and below are available, and
/// multiplied by the surrounding terms in step n + 3. Products are summed over neighbours up to two pixels apart along
/// either axis, with weight one half at two pixels. The spline of the deformation spreads pixel noise over its
/// neighbours; beyond two pixels the resulting covariance alternates in sign and cancels. Products with rows above are
/// doubled to include those with rows below.
template <class Columns>
struct WindowStatistics {
  using Value = typename Columns::Value;

  float* memory;  ///< scratch memory of values(side) floats
  int side;       ///< side of the window [px]
  int thread;     ///< index of this thread, 0 .. threads - 1; threads process interleaved groups of columns
  int threads;

  static constexpr int margin = 8;  ///< number of columns of zeros on either side, of which the terms use two
  GLADSTONE_HD static int pitch(int side) { return (side + 7) / 8 * 8 + 2 * margin; }
  GLADSTONE_HD static int values(int side) { return rows * pitch(side); }
  GLADSTONE_HD static int steps(int side) { return side + 3; }

  GLADSTONE_HD void clear() const {
    for (int k = thread * Columns::count; k < values(side); k += threads * Columns::count)
      Columns::store(memory + k, Value{});
  }

  /// Returns this thread's share of the weighted sums of both frames.
  /// @param pixels  at(x, row): MatchedPixels of columns x .. x + Columns::count - 1, with weight 0 beyond the window
  template <class Pixels>
  GLADSTONE_HD WindowSums<double> sum_pixels(Pixels const& pixels) const {
    WindowSums<double> sums;
    for (int row = 0; row < side; ++row) {
      WindowSums<Value> here;
      for (int x = first(); x < side; x += ahead()) {
        MatchedPixels<Value> const pixel = pixels.at(x, row);
        here.weight += pixel.weight;
        here.reference += pixel.weight * pixel.reference;
        here.flow += pixel.weight * pixel.flow;
      }
      sums.weight += Columns::sum(here.weight);
      sums.reference += Columns::sum(here.reference);
      sums.flow += Columns::sum(here.flow);
    }
    return sums;
  }

  /// Returns this thread's share of the weighted sums of squares of frames A (x) and B (y). @param means  means of both
  /// frames
  template <class Pixels>
  GLADSTONE_HD Vec2d sum_squares(Pixels const& pixels, WindowLevels const& means) const {
    Vec2d sums;
    for (int row = 0; row < side; ++row) {
      Value reference{}, flow{};
      for (int x = first(); x < side; x += ahead()) {
        MatchedPixels<Value> const pixel = pixels.at(x, row);
        Value const a = pixel.weight * (pixel.reference - means.reference);
        Value const b = pixel.weight * (pixel.flow - means.flow);
        reference += a * a;
        flow += b * b;
      }
      sums += {Columns::sum(reference), Columns::sum(flow)};
    }
    return sums;
  }

  /// Performs step n of a pipeline over the rows of the window: weighs row n, forms the terms of row n - 2, and adds
  /// the products of the terms of row n - 3. @param sums  this thread's share of the sums
  template <class Pixels>
  GLADSTONE_HD void step(int n, Pixels const& pixels, WindowLevels const& levels, StatisticsSums& sums) const {
    if (n <= side) weigh_row(n, pixels, levels);
    if (n >= 2 && n < side + 2) form_terms(n - 2, sums);
    if (n >= 3) multiply_terms(n - 3, sums);
  }

 private:
  /// Number of rows of each image in memory: one being written, three being read.
  static constexpr int weighted_rows = 4;
  static constexpr int image_count = 3;  ///< number of images: A, B, w
  static constexpr int term_count = 4;   ///< number of terms: p^2 and t along x, then along y
  static constexpr int rows = image_count * weighted_rows + 2 * term_count + 2 * term_count;

  GLADSTONE_HD int first() const { return thread * Columns::count; }
  GLADSTONE_HD int ahead() const { return threads * Columns::count; }
  GLADSTONE_HD float* row_in_memory(int number) const { return memory + number * pitch(side) + margin; }
  /// Returns a weighted row of an image. clear() sets row -1 to zero; row `side` is written as zeros.
  GLADSTONE_HD float* weighted(int image, int row) const {
    return row_in_memory(image * weighted_rows + (row + weighted_rows) % weighted_rows);
  }
  GLADSTONE_HD float* terms(int which, int row) const {
    return row_in_memory(image_count * weighted_rows + 2 * which + row % 2);
  }
  /// Returns the sums of a row's terms over their neighbours along x; only the thread that wrote these sums reads them.
  GLADSTONE_HD float* across(int which, int row) const {
    return row_in_memory(image_count * weighted_rows + 2 * term_count + 2 * which + row % 2);
  }

  template <class Pixels>
  GLADSTONE_HD void weigh_row(int row, Pixels const& pixels, WindowLevels const& levels) const {
    float *const a = weighted(0, row), *const b = weighted(1, row), *const w = weighted(2, row);
    for (int x = first(); x < side; x += ahead()) {
      MatchedPixels<Value> const pixel = row < side ? pixels.at(x, row) : MatchedPixels<Value>{};
      Columns::store(a + x, pixel.weight * (pixel.reference - levels.reference));
      Columns::store(b + x, levels.flow_gain * (pixel.weight * (pixel.flow - levels.flow)));
      Columns::store(w + x, pixel.weight);
    }
  }

  GLADSTONE_HD void form_terms(int row, StatisticsSums& sums) const {
    float const *const a = weighted(0, row), *const b = weighted(1, row), *const w = weighted(2, row);
    float const *const a_above = weighted(0, row - 1), *const b_above = weighted(1, row - 1);
    float const *const a_below = weighted(0, row + 1), *const b_below = weighted(1, row + 1);
    float const* const w_below = weighted(2, row + 1);
    float* const out[term_count] = {terms(0, row), terms(1, row), terms(2, row), terms(3, row)};
    Value centre{}, whole{}, beside[2]{}, overlap[2]{}, shares[2]{}, squares[2]{};
    for (int x = first(); x < side; x += ahead()) {
      Value const a0 = Columns::load(a + x), b0 = Columns::load(b + x), w0 = Columns::load(w + x);
      centre += a0 * b0;
      whole += w0 * w0;
      auto const along = [&](int axis, Value q_before, Value a_next, Value b_next, Value w_next) {
        beside[axis] += 0.5f * (a0 * b_next + a_next * b0);
        overlap[axis] += w0 * w_next;
        Value const slope = 0.5f * (q_before - (a_next + b_next)), share = w0 * slope, square = share * share;
        Value const term = slope * (b0 - a0);
        shares[axis] += square;
        Columns::store(out[2 * axis] + x, square);
        squares[axis] += term * term;
        Columns::store(out[2 * axis + 1] + x, term);
      };
      along(0, Columns::load(a + x - 1) + Columns::load(b + x - 1), Columns::load(a + x + 1), Columns::load(b + x + 1),
            Columns::load(w + x + 1));
      along(1, Columns::load(a_above + x) + Columns::load(b_above + x), Columns::load(a_below + x),
            Columns::load(b_below + x), Columns::load(w_below + x));
    }
    sums.centre += Columns::sum(centre);
    sums.whole += Columns::sum(whole);
    for (int axis = 0; axis < 2; ++axis) {
      sums.beside[axis] += Columns::sum(beside[axis]);
      sums.overlap[axis] += Columns::sum(overlap[axis]);
      sums.shares[axis] += Columns::sum(shares[axis]);
      sums.squares[axis] += Columns::sum(squares[axis]);
    }
  }

  GLADSTONE_HD void multiply_terms(int row, StatisticsSums& sums) const {
    auto const products = [&](int which) {
      float const* const t = terms(which, row);
      float const* const above = across(which, row + 1);  // terms of row - 1, which shares memory with row + 1
      float* const here = across(which, row);             // terms of row - 2, until they are overwritten
      Value sum{};
      for (int x = first(); x < side; x += ahead()) {
        Value const middle = Columns::load(t + x);
        Value const line = middle + (Columns::load(t + x - 1) + Columns::load(t + x + 1)) +
                           0.5f * (Columns::load(t + x - 2) + Columns::load(t + x + 2));
        sum += middle * (line + 2.0f * Columns::load(above + x) + Columns::load(here + x));
        Columns::store(here + x, line);
      }
      return Columns::sum(sum);
    };
    for (int axis = 0; axis < 2; ++axis) {
      sums.lost[axis] += products(2 * axis);
      sums.terms[axis] += products(2 * axis + 1);
    }
  }
};

/// Upper bound of the variance: that of a uniform distribution within one pixel of the highest sample [px^2]. Without
/// this bound, nearly flat peaks would yield arbitrarily large values.
constexpr double largest_variance = 1.0 / 3.0;

/// Lower bound of the variance, as a fraction of the variance without the covariances between terms. Without noise,
/// errors of interpolation remain, whose sign alternates from pixel to pixel: terms cancel their neighbours, and the
/// sum over neighbours can be zero or negative. For N independent terms, the sum has a relative standard error of
/// sqrt(2 (3.5^2 - 1) / N), where 3.5 is the sum of the squared weights along an axis. This error is 0.1 for N = 2250,
/// the number of pixels of four windows of 24 px, over which the mean over 3 x 3 windows at half overlap extends. A
/// smaller sum cannot be distinguished from zero.
constexpr double smallest_share = 0.1;

/// Returns the variance of a displacement along an axis (0: x, 1: y) [px^2]; NaN if the peak has no maximum.
/// - The three-point Gaussian fit u = (ln C- - ln C+)/(2 (ln C+ + ln C- - 2 ln C0)) gives sigma_u = sigma(C+ - C-)/(4
///   C1 ln(C0/C1)), with C1 the mean of C+ and C-.
/// - The terms a_i b_(i+1) - a_(i+1) b_i of C+ - C- equal s_i d_(i+1) - s_(i+1) d_i up to a factor, with s the sum
///   and d the difference of the frames. Summation by parts gives d_i (s_(i-1) - s_(i+1)): the noise of a pixel then
///   occurs in one term only, instead of two terms of opposite sign whose covariance extends over a dot diameter.
/// - The frames were matched by the displacement whose uncertainty is estimated, which reduces the sum of the terms.
///   For uniform noise, the share of a term in the variance is p_i^2/sum p^2, and the relative reduction is the sum of
///   the products of two shares over all pairs of neighbouring terms. The result is corrected for this reduction.
/// - The variance is at least smallest_share times the variance without covariances between terms.
GLADSTONE_HD inline double displacement_variance(StatisticsSums const& sums, int axis) {
  using std::log;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  // Divide out the decrease caused by the weights, as the correlator does.
  double const shift_attenuation = sums.overlap[axis] / sums.whole, beside = sums.beside[axis] / shift_attenuation;
  if (!(beside > 0.0 && sums.centre > beside)) return nan;
  double const slope = 4.0 * beside * log(sums.centre / beside) * shift_attenuation;
  double const lost = sums.lost[axis] / (sums.shares[axis] * sums.shares[axis]);
  double const least = smallest_share * sums.squares[axis];
  double const terms = sums.terms[axis] > least ? sums.terms[axis] : least;
  double const variance = terms / ((1.0 - lost) * slope * slope);
  return variance > largest_variance ? largest_variance : variance;
}

}  // namespace gladstone::inline uncertainty
