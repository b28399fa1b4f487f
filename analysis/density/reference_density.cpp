#include "analysis/density/reference_density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline density {
namespace {

void check_reference_value(double value, double sigma) {
  if (!std::isfinite(value))
    throw SetupError({SetupProblem{"reference", fmt::format("expected a finite density, got {}", value)}});
  if (!(sigma >= 0.0) || !std::isfinite(sigma))
    throw SetupError({SetupProblem{"reference", fmt::format("expected an uncertainty of 0 or more, got {}", sigma)}});
}

}  // namespace

ReferenceDensity make_box_reference(PlaneGrid const& grid, Vec2d low, Vec2d high, double value, double sigma) {
  check_reference_value(value, sigma);
  ReferenceDensity reference{std::vector<double>(grid.size(), not_a_number), sigma};
  bool found = false;
  double const slack_x = 1e-9 * grid.spacing.x, slack_y = 1e-9 * grid.spacing.y;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      Vec2d const p = grid.position(column, row);
      if (p.x < low.x - slack_x || p.x > high.x + slack_x || p.y < low.y - slack_y || p.y > high.y + slack_y) continue;
      reference.value[grid.index(column, row)] = value;
      found = true;
    }
  if (found) return reference;
  Vec2d const first = grid.position(0, 0), last = grid.position(grid.columns - 1, grid.rows - 1);
  throw SetupError(
      {SetupProblem{"reference", fmt::format("no vector lies within x {:.4g} to {:.4g} mm, y {:.4g} to {:.4g} mm (the "
                                             "vectors cover x {:.4g} to {:.4g} mm, y {:.4g} to {:.4g} mm); move or "
                                             "enlarge the reference region",
                                             1e3 * low.x, 1e3 * high.x, 1e3 * low.y, 1e3 * high.y, 1e3 * first.x,
                                             1e3 * last.x, 1e3 * first.y, 1e3 * last.y)}});
}

ReferenceDensity make_side_reference(PlaneGrid const& grid, GridSide side, double value, int depth, double sigma) {
  check_reference_value(value, sigma);
  bool const along_x = side == GridSide::left || side == GridSide::right;
  int const limit = along_x ? grid.columns : grid.rows;
  if (depth < 1 || depth > limit)
    throw SetupError(
        {SetupProblem{"reference", fmt::format("expected a depth from 1 to {} nodes, got {}", limit, depth)}});
  ReferenceDensity reference{std::vector<double>(grid.size(), not_a_number), sigma};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      int const position = along_x ? column : row;
      bool const from_end = side == GridSide::right || side == GridSide::top;
      int const distance = from_end ? limit - 1 - position : position;
      if (distance < depth) reference.value[grid.index(column, row)] = value;
    }
  return reference;
}

ReferenceDensity combine_references(ReferenceDensity a, ReferenceDensity const& b) {
  GLADSTONE_EXPECTS(a.value.size() == b.value.size());
  for (std::size_t i = 0; i < a.value.size(); ++i)
    if (!std::isnan(b.value[i])) a.value[i] = b.value[i];
  a.sigma = std::max(a.sigma, b.sigma);
  return a;
}

}  // namespace gladstone::inline density
