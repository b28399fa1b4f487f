#include "analysis/density/line_differences.h"

namespace gladstone::inline density {
namespace {

struct Step {
  int x, y;
};

/// Sets up the equation of the edge from (column, row) to the next node along the step.
LineDifference make_difference(GradientMap const& map, int column, int row, Step step, EdgeRule rule) {
  PlaneGrid const& grid = map.grid;
  LineDifference d;
  d.axis = step.x != 0 ? LineAxis::x : LineAxis::y;
  double const h = step.x != 0 ? grid.spacing.x : grid.spacing.y;
  auto const node_at = [&](int k) { return grid.index(column + k * step.x, row + k * step.y); };
  auto const is_valid = [&](int k) { return map.is_valid(column + k * step.x, row + k * step.y); };
  d.from = node_at(0);
  d.to = node_at(1);
  auto const add = [&](int k, double factor) {
    d.node[d.terms] = node_at(k);
    d.factor[d.terms++] = factor * h;
  };
  bool const before = rule == EdgeRule::four_point && is_valid(-1);
  bool const after = rule == EdgeRule::four_point && is_valid(2);
  if (before && after) {
    add(-1, -1.0 / 24.0);
    add(0, 13.0 / 24.0);
    add(1, 13.0 / 24.0);
    add(2, -1.0 / 24.0);
  } else if (before) {
    add(-1, -1.0 / 12.0);
    add(0, 8.0 / 12.0);
    add(1, 5.0 / 12.0);
  } else if (after) {
    add(0, 5.0 / 12.0);
    add(1, 8.0 / 12.0);
    add(2, -1.0 / 12.0);
  } else {
    add(0, 0.5);
    add(1, 0.5);
  }
  // Count the complete grid cells on both sides of the edge.
  for (int side : {-1, 1}) {
    int const dx = side * step.y, dy = side * step.x;
    d.cells += map.is_valid(column + dx, row + dy) && map.is_valid(column + step.x + dx, row + step.y + dy);
  }
  return d;
}

}  // namespace

std::vector<LineDifference> make_line_differences(GradientMap const& map, EdgeRule rule) {
  std::vector<LineDifference> differences;
  differences.reserve(2 * map.grid.size());
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 0; column < map.grid.columns; ++column) {
      if (!map.is_valid(column, row)) continue;
      if (map.is_valid(column + 1, row)) differences.push_back(make_difference(map, column, row, {1, 0}, rule));
      if (map.is_valid(column, row + 1)) differences.push_back(make_difference(map, column, row, {0, 1}, rule));
    }
  return differences;
}

double compute_variance(LineDifference const& difference, std::vector<Vec2d> const& sigma) {
  double sum = 0.0;
  for (std::size_t i = 0; i < difference.terms; ++i) {
    Vec2d const s = sigma.empty() ? Vec2d{1.0, 1.0} : sigma[difference.node[i]];
    double const term = difference.factor[i] * (difference.axis == LineAxis::x ? s.x : s.y);
    sum += term * term;
  }
  return sum;
}

}  // namespace gladstone::inline density
