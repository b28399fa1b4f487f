#include "studies/sweep/vector_errors.h"

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"

namespace gladstone::inline sweep {
namespace {

double rounded(double error_px) { return std::round(error_px / vector_unit_px) * vector_unit_px; }

/// Selects the vectors to store: every step-th row and column of a lattice, or every step-th of scattered vectors.
std::vector<std::size_t> kept_vectors(DisplacementField const& field) {
  bool const lattice = field.columns > 0 && field.rows > 0;
  std::size_t const columns = lattice ? static_cast<std::size_t>(field.columns) : field.size();
  std::size_t const rows = lattice ? static_cast<std::size_t>(field.rows) : 1;
  auto const count_kept = [](std::size_t count, std::size_t step) { return (count + step - 1) / step; };
  std::size_t step = 1;
  while (count_kept(columns, step) * count_kept(rows, rows > 1 ? step : 1) > most_kept_vectors) ++step;
  std::vector<std::size_t> kept;
  for (std::size_t row = 0; row < rows; row += step) {
    for (std::size_t column = 0; column < columns; column += step) kept.push_back(row * columns + column);
  }
  return kept;
}

}  // namespace

std::vector<std::string> const& vector_error_names() {
  static std::vector<std::string> const names{"ray_truth", "eq9", "estimator"};
  return names;
}

std::vector<VectorErrors> vector_errors(Comparison const& comparison) {
  std::vector<std::size_t> const kept = kept_vectors(comparison.measured);
  std::vector<Vec2d> const& measured = comparison.measured.displacement_px;
  std::vector<VectorErrors> errors;
  auto const add = [&](std::vector<Vec2d> const& from, std::vector<Vec2d> const& to) {
    VectorErrors one{vector_error_names()[errors.size()], {}};
    for (std::size_t const i : kept) {
      bool const known = comparison.mask[i] != 0 && !to.empty();
      Vec2d const error = known ? to[i] - from[i] : Vec2d{not_a_number, not_a_number};
      one.errors_px.push_back({rounded(error.x), rounded(error.y)});
    }
    errors.push_back(std::move(one));
  };
  add(comparison.point.displacement_px, measured);
  add(comparison.point.eq9_px, measured);
  add(comparison.window.displacement_px, comparison.noise_free);
  return errors;
}

RepeatSplit split_repeats(std::span<std::vector<Vec2d> const> repeats) {
  RepeatSplit split{0, not_a_number, not_a_number};
  if (repeats.size() < 2) return split;
  std::size_t const size = repeats.front().size();
  if (std::any_of(repeats.begin(), repeats.end(), [&](auto const& one) { return one.size() != size; })) return split;
  auto const count = static_cast<double>(repeats.size());
  double squares_of_means = 0, variances = 0;
  for (std::size_t i = 0; i < size; ++i) {
    Vec2d sum{};
    for (auto const& one : repeats) sum += one[i];
    if (!is_finite(sum)) continue;
    Vec2d const mean = sum / count;
    double square = 0;
    for (auto const& one : repeats) square += dot(one[i] - mean, one[i] - mean);
    squares_of_means += dot(mean, mean);
    variances += square / (count - 1);
    ++split.vectors;
  }
  if (split.vectors == 0) return split;
  double const components = 2 * static_cast<double>(split.vectors);
  double const scatter2 = variances / components;
  split.scatter_px = std::sqrt(scatter2);
  split.systematic_px = std::sqrt(std::max(0.0, squares_of_means / components - scatter2 / count));
  return split;
}

MeanAndSpread mean_and_spread(std::span<double const> values) {
  double sum = 0, squares = 0;
  std::size_t count = 0;
  for (double const value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  if (count == 0) return {not_a_number, not_a_number};
  double const mean = sum / static_cast<double>(count);
  for (double const value : values) squares += std::isfinite(value) ? (value - mean) * (value - mean) : 0;
  return {mean, count < 2 ? not_a_number : std::sqrt(squares / static_cast<double>(count - 1))};
}

}  // namespace gladstone::inline sweep
