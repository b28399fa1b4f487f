#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/uncertainty/matched_windows.h"

namespace gladstone {
namespace {

/// Terms of the difference are summed over squares of this side before they are squared: that adds the covariance of
/// neighbours, with weights that fall off linearly with their distance (Bartlett). Terms of dots of 2 to 4 px have
/// nothing in common beyond.
constexpr int block_px = 5;
/// What the linear fall-off leaves out of the covariance of dots of 3 px, and what the spline that deforms adds; found
/// on the seeds of docs/estimators.md.
constexpr double calibration = 1.3;

/// Sum of the squares of all sums over blocks, each block's share of a term taken off: the variance of the whole sum.
double variance_of_sum(std::vector<float> const& term, int columns, int rows, std::vector<double>& across) {
  int const wide = columns + block_px - 1;
  across.assign(static_cast<std::size_t>(wide) * rows, 0.0);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (int k = 0; k < block_px; ++k)
        across[static_cast<std::size_t>(j) * wide + i + k] += term[static_cast<std::size_t>(j) * columns + i];
  double sum = 0.0;
  std::vector<double> column(static_cast<std::size_t>(wide));
  for (int j = 0; j < rows + block_px - 1; ++j) {
    std::fill(column.begin(), column.end(), 0.0);
    for (int k = std::max(0, j - rows + 1); k < block_px && k <= j; ++k)
      for (int i = 0; i < wide; ++i)
        column[static_cast<std::size_t>(i)] += across[static_cast<std::size_t>(j - k) * wide + i];
    for (double const value : column) sum += value * value;
  }
  return sum / (block_px * block_px);
}

/// Standard uncertainty along an axis: of three points of a Gaussian peak, u = (ln C- - ln C+)/(2 (ln C+ + ln C- -
/// 2 ln C0)), so that sigma_u = sigma(C+ - C-)/(4 C1 ln(C0/C1)), C1 the mean of both.
double uncertainty_along(MatchedWindow const& w, int dx, int dy, std::vector<float>& term,
                         std::vector<double>& scratch) {
  int const columns = w.side - dx, rows = w.side - dy;
  term.resize(static_cast<std::size_t>(columns) * rows);
  double centre = 0.0, beside = 0.0;
  for (std::size_t k = 0; k < w.weight.size(); ++k)
    centre += static_cast<double>(w.weight[k]) * w.weight[k] * w.reference[k] * w.flow[k];
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      std::size_t const here = w.at(i, j), there = w.at(i + dx, j + dy);
      float const weight = w.weight[here] * w.weight[there];
      float const forward = w.reference[here] * w.flow[there], backward = w.reference[there] * w.flow[here];
      term[static_cast<std::size_t>(j) * columns + i] = weight * (forward - backward);
      beside += 0.5 * static_cast<double>(weight) * (forward + backward);
    }
  if (!(beside > 0.0 && centre > beside)) return std::numeric_limits<double>::quiet_NaN();
  double const deviation = std::sqrt(variance_of_sum(term, columns, rows, scratch));
  return calibration * deviation / (4.0 * beside * std::log(centre / beside));
}

}  // namespace

std::vector<Vec2d> correlation_statistics(UncertaintyInput const& input) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> u(input.field.size(), nan), v = u;
  visit_matched_windows(input, [&](std::size_t i, MatchedWindow const& window) {
    thread_local std::vector<float> term;
    thread_local std::vector<double> scratch;
    double const along_x = uncertainty_along(window, 1, 0, term, scratch);
    double const along_y = uncertainty_along(window, 0, 1, term, scratch);
    u[i] = along_x * along_x;
    v[i] = along_y * along_y;
  });
  return sigma_of_variances(u, v, input.grid);
}

}  // namespace gladstone
