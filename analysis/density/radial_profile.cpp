#include "analysis/density/radial_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/density/lagrange_cubics.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline density {
namespace {

using Weights = std::vector<std::pair<int, double>>;  ///< columns of nodes, with their interpolation weights

/// Returns the interpolation weights at a position in a row [columns]; nullopt if a neighbouring node is invalid or
/// outside the grid.
std::optional<Weights> interpolate_row(GradientMap const& map, int row, double position) {
  double const nearest = std::round(position);
  bool const is_at_node = std::abs(position - nearest) < 1e-9;
  int const i = static_cast<int>(is_at_node ? nearest : std::floor(position));
  double const t = is_at_node ? 0.0 : position - i;
  auto const is_valid = [&](int column) { return map.is_valid(column, row); };
  if (!is_valid(i)) return std::nullopt;
  if (t == 0.0) return Weights{{i, 1.0}};
  if (!is_valid(i + 1)) return std::nullopt;
  if (!is_valid(i - 1) || !is_valid(i + 2)) return Weights{{i, 1.0 - t}, {i + 1, t}};
  std::array<double, 4> const cubic = lagrange_cubics(t);
  return Weights{{i - 1, cubic[0]}, {i, cubic[1]}, {i + 1, cubic[2]}, {i + 2, cubic[3]}};
}

/// Gradient on one side of the axis and its variance.
struct SideValue {
  double value = 0.0, variance = 0.0;
};

SideValue evaluate_side(GradientMap const& map, int row, Weights const& weights) {
  SideValue side;
  for (auto const& [column, factor] : weights) {
    std::size_t const i = map.grid.index(column, row);
    double const sigma = map.sigma.empty() ? 1.0 : map.sigma[i].x;
    side.value += factor * map.gradient[i].x;
    side.variance += factor * factor * sigma * sigma;
  }
  return side;
}

}  // namespace

int RadialProfile::last_measured() const {
  auto last = static_cast<int>(gradient.size()) - 1;
  while (last > 0 && !std::isfinite(gradient[last])) --last;
  return last;
}

int count_radii(PlaneGrid const& grid, double axis) {
  double const left = (axis - grid.origin.x) / grid.spacing.x, right = grid.columns - 1 - left;
  return static_cast<int>(std::floor(std::max(left, right) + 1e-9)) + 1;
}

RadialProfile fold_row(GradientMap const& map, int row, double axis) {
  int const radii = count_radii(map.grid, axis);
  double const centre = (axis - map.grid.origin.x) / map.grid.spacing.x;
  RadialProfile profile;
  profile.gradient = Eigen::VectorXd::Constant(radii, not_a_number);
  profile.sigma = Eigen::VectorXd::Constant(radii, not_a_number);
  profile.fold = Eigen::MatrixXd::Zero(radii, map.grid.columns);
  profile.gradient[0] = 0.0;
  profile.sigma[0] = 1.0;
  for (int k = 1; k < radii; ++k) {
    std::optional<Weights> const right = interpolate_row(map, row, centre + k);
    std::optional<Weights> const left = interpolate_row(map, row, centre - k);
    if (!right && !left) continue;
    SideValue const r = right ? evaluate_side(map, row, *right) : SideValue{};
    SideValue const l = left ? evaluate_side(map, row, *left) : SideValue{};
    double const weight_r = right ? 1.0 / r.variance : 0.0, weight_l = left ? 1.0 / l.variance : 0.0;
    double const share = weight_r / (weight_r + weight_l);
    profile.gradient[k] = share * r.value - (1.0 - share) * l.value;
    profile.sigma[k] = std::sqrt(1.0 / (weight_r + weight_l));
    if (right)
      for (auto const& [column, factor] : *right) profile.fold(k, column) += share * factor;
    if (left)
      for (auto const& [column, factor] : *left) profile.fold(k, column) -= (1.0 - share) * factor;
    if (!right || !left) continue;
    profile.odd_square += 0.25 * (r.value - l.value) * (r.value - l.value);
    profile.even_square += 0.25 * (r.value + l.value) * (r.value + l.value);
    profile.product_square += r.value * r.value * l.value * l.value;
  }
  return profile;
}

}  // namespace gladstone::inline density
