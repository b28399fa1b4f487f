#include "analysis/density/window_correlation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/error.h"

namespace gladstone::inline density {
namespace {

/// Throws SetupError if windows of `window` grid steps do not fit into an axis of `size` nodes.
void check_window(int size, double window) {
  if (window > 0.0 && std::isfinite(window) && window <= size) return;
  throw SetupError(
      {SetupProblem{"overlap", fmt::format("expected windows of 0 to {} grid steps, got {}", size, window)}});
}

}  // namespace

WindowOverlap WindowOverlap::from_fraction(double overlap) {
  if (!(overlap >= 0.0 && overlap < 1.0))
    throw SetupError({SetupProblem{"overlap", fmt::format("expected a fraction from 0 to below 1, got {}", overlap)}});
  return {1.0 / (1.0 - overlap), 1.0 / (1.0 - overlap)};
}

void check_window_overlap(int columns, int rows, WindowOverlap overlap) {
  check_window(columns, overlap.x);
  check_window(rows, overlap.y);
}

WindowCorrelation::Factor WindowCorrelation::factorize(int size, double window) {
  check_window(size, window);
  Factor factor;
  factor.size = size;
  factor.band = std::max(0, static_cast<int>(std::ceil(window)) - 1);
  factor.element.assign(static_cast<std::size_t>(size) * (factor.band + 1), 0.0);
  for (int i = 0; i < size; ++i) {
    for (int j = std::max(0, i - factor.band); j <= i; ++j) {
      double sum = std::max(0.0, 1.0 - (i - j) / std::max(window, 1.0));
      for (int k = std::max(0, i - factor.band); k < j; ++k)
        if (k >= j - factor.band) sum -= factor(i, k) * factor(j, k);
      double const value = i == j ? std::sqrt(std::max(sum, 1e-14)) : sum / factor(j, j);
      factor.element[static_cast<std::size_t>(i) * (factor.band + 1) + (j - i + factor.band)] = value;
    }
  }
  return factor;
}

WindowCorrelation::WindowCorrelation(int columns, int rows, WindowOverlap overlap)
    : columns_(columns), rows_(rows), along_x_(factorize(columns, overlap.x)), along_y_(factorize(rows, overlap.y)) {}

template <bool transposed>
std::vector<double> WindowCorrelation::multiply(std::span<double const> values) const {
  GLADSTONE_EXPECTS(values.size() == static_cast<std::size_t>(columns_) * rows_);
  std::vector<double> half(values.size()), result(values.size());
  auto const at = [&](int column, int row) { return static_cast<std::size_t>(row) * columns_ + column; };
  for (int row = 0; row < rows_; ++row)
    for (int i = 0; i < columns_; ++i)
      for (int k = std::max(0, i - along_x_.band); k <= i; ++k)
        half[at(transposed ? k : i, row)] += along_x_(i, k) * values[at(transposed ? i : k, row)];
  for (int j = 0; j < rows_; ++j)
    for (int k = std::max(0, j - along_y_.band); k <= j; ++k)
      for (int i = 0; i < columns_; ++i)
        result[at(i, transposed ? k : j)] += along_y_(j, k) * half[at(i, transposed ? j : k)];
  return result;
}

std::vector<double> WindowCorrelation::correlate(std::span<double const> values) const {
  return multiply<false>(values);
}

std::vector<double> WindowCorrelation::correlate_transposed(std::span<double const> values) const {
  return multiply<true>(values);
}

}  // namespace gladstone::inline density
