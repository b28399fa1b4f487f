#include "analysis/density/symmetry_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/density/lagrange_cubics.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline density {
namespace {

/// Gradient across the axis minus its mean; zero at invalid nodes and outside the grid.
class CrossGradient {
 public:
  explicit CrossGradient(GradientMap const& map) : grid_(map.grid) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < map.grid.size(); ++i)
      if (map.valid[i] != 0) {
        sum += map.gradient[i].x;
        count += 1.0;
      }
    for (std::size_t i = 0; i < map.grid.size(); ++i)
      value_.push_back(map.valid[i] != 0 ? map.gradient[i].x - sum / count : 0.0);
  }

  double node(int column, int row) const {
    return grid_.contains(column, row) ? value_[grid_.index(column, row)] : 0.0;
  }

  /// Returns the value at a position between nodes, interpolated by the cubic through four nodes.
  double at(double column, int row) const {
    double const floor = std::floor(column), t = column - floor;
    int const i = static_cast<int>(floor);
    if (t == 0.0) return node(i, row);
    std::array<double, 4> const cubic = lagrange_cubics(t);
    return cubic[0] * node(i - 1, row) + cubic[1] * node(i, row) + cubic[2] * node(i + 1, row) +
           cubic[3] * node(i + 2, row);
  }

  /// Symmetry S(c) of find_symmetry_axis(), with c in columns.
  double symmetry(double centre) const {
    double sum = 0.0;
    for (int row = 0; row < grid_.rows; ++row)
      for (int column = 0; column < grid_.columns; ++column) {
        double const mirrored = 2.0 * centre - column;
        if (mirrored < -2.0 || mirrored > grid_.columns + 1.0) continue;
        sum -= node(column, row) * at(mirrored, row);
      }
    return sum;
  }

 private:
  PlaneGrid grid_;
  std::vector<double> value_;
};

/// Maximises S(c) within one node of a start value by golden-section search.
double refine_centre(CrossGradient const& gradient, double start) {
  constexpr double golden = 0.61803398874989485;
  double low = start - 1.0, high = start + 1.0;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double value_a = gradient.symmetry(a), value_b = gradient.symmetry(b);
  while (high - low > 1e-6) {
    if (value_a > value_b) {
      high = b;
      b = a;
      value_b = value_a;
      value_a = gradient.symmetry(a = high - golden * (high - low));
    } else {
      low = a;
      a = b;
      value_a = value_b;
      value_b = gradient.symmetry(b = low + golden * (high - low));
    }
  }
  return 0.5 * (low + high);
}

/// Computes the variance of the centre, sum (sigma g')^2 / (sum g'^2)^2 times the number of nodes that share their
/// errors because of the window overlap [columns^2].
double compute_centre_variance(GradientMap const& map, CrossGradient const& gradient, WindowOverlap overlap) {
  if (map.sigma.empty()) return not_a_number;
  double weighted = 0.0, slopes = 0.0;
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 1; column + 1 < map.grid.columns; ++column) {
      if (!map.is_valid(column, row)) continue;
      double const slope = 0.5 * (gradient.node(column + 1, row) - gradient.node(column - 1, row));
      double const sigma = map.sigma[map.grid.index(column, row)].x;
      weighted += slope * slope * sigma * sigma;
      slopes += slope * slope;
    }
  return weighted / (slopes * slopes) * std::max(overlap.x, 1.0) * std::max(overlap.y, 1.0);
}

}  // namespace

GradientMap transpose_map(GradientMap const& map) {
  GradientMap transposed;
  PlaneGrid const& grid = map.grid;
  transposed.grid = {grid.rows, grid.columns, {grid.origin.y, grid.origin.x}, {grid.spacing.y, grid.spacing.x}};
  for (int column = 0; column < grid.columns; ++column)
    for (int row = 0; row < grid.rows; ++row) {
      std::size_t const i = grid.index(column, row);
      transposed.valid.push_back(map.valid[i]);
      transposed.gradient.push_back({map.gradient[i].y, map.gradient[i].x});
      if (!map.sigma.empty()) transposed.sigma.push_back({map.sigma[i].y, map.sigma[i].x});
    }
  return transposed;
}

SymmetryAxis find_symmetry_axis(GradientMap const& map, AxisDirection direction, WindowOverlap overlap) {
  check_gradient_map(map);
  if (direction == AxisDirection::horizontal)
    return find_symmetry_axis(transpose_map(map), AxisDirection::vertical, overlap);
  CrossGradient const gradient(map);
  int const columns = map.grid.columns;
  double best = 0.0, best_symmetry = 0.0;
  for (int half = 0; half <= 2 * (columns - 1); ++half) {
    double const symmetry = gradient.symmetry(0.5 * half);
    if (symmetry <= best_symmetry) continue;
    best = 0.5 * half;
    best_symmetry = symmetry;
  }
  if (best_symmetry <= 0.0)
    throw DataError(ErrorCode::undetermined, "axis",
                    "no axis of symmetry can be found (the gradient across it vanishes or is not odd); give "
                    "the axis, or integrate without axial symmetry");
  if (best < 2.0 || best > columns - 3.0)
    throw DataError(ErrorCode::undetermined, "axis",
                    fmt::format("the axis of symmetry was found at the border of the image ({:.4g} mm); give "
                                "the axis, or enlarge the field of view",
                                1e3 * (map.grid.origin.x + best * map.grid.spacing.x)));
  double const centre = refine_centre(gradient, best);
  return {map.grid.origin.x + centre * map.grid.spacing.x,
          map.grid.spacing.x * std::sqrt(compute_centre_variance(map, gradient, overlap))};
}

}  // namespace gladstone::inline density
