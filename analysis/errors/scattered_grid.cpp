#include "analysis/errors/scattered_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/point_cells.h"

namespace gladstone::inline errors {
namespace {

/// Weighted sums for the fit of a plane to scattered values, with offsets from the node in units of h.
struct PlaneFit {
  int dots = 0;
  double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, wyy = 0.0;
  Vec2d d{}, dx{}, dy{};

  void add(Vec2d offset, Vec2d value, double weight) {
    ++dots;
    w += weight;
    wx += weight * offset.x;
    wy += weight * offset.y;
    wxx += weight * offset.x * offset.x;
    wxy += weight * offset.x * offset.y;
    wyy += weight * offset.y * offset.y;
    d += weight * value;
    dx += weight * offset.x * value;
    dy += weight * offset.y * value;
  }

  double cofactor() const { return wxx * wyy - wxy * wxy; }
  double determinant() const { return w * cofactor() + wx * (wxy * wy - wx * wyy) + wy * (wx * wxy - wxx * wy); }

  /// Returns the variance of the fitted value at the node relative to that of one dot, from the inverse of the normal
  /// matrix: below 1 for interpolation, large for extrapolation. Infinite for fewer than four dots or a singular fit.
  double amplification() const {
    double const det = determinant();
    return dots >= 4 && det > 1e-9 * w * w * w ? cofactor() / det : std::numeric_limits<double>::infinity();
  }

  /// Returns the value of the plane at the node, by Cramer's rule.
  Vec2d at_node() const {
    return (cofactor() * d + (wxy * wy - wx * wyy) * dx + (wx * wxy - wxx * wy) * dy) / determinant();
  }
};

double mean_spacing(std::span<Vec2d const> points) {
  Vec2d low{not_a_number, not_a_number}, high{not_a_number, not_a_number};
  std::size_t count = 0;
  for (Vec2d const& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
    low = count == 0 ? p : Vec2d{std::min(low.x, p.x), std::min(low.y, p.y)};
    high = count == 0 ? p : Vec2d{std::max(high.x, p.x), std::max(high.y, p.y)};
    ++count;
  }
  double const area = count == 0 ? 0.0 : (high.x - low.x) * (high.y - low.y);
  return area > 0.0 ? std::sqrt(area / static_cast<double>(count)) : 1.0;
}

}  // namespace

DisplacementMaps map_scattered(std::span<Vec2d const> position_px, std::span<Vec2d const> displacement_px,
                               MapGrid const& grid) {
  GLADSTONE_EXPECTS(position_px.size() == displacement_px.size());
  GLADSTONE_EXPECTS(grid.columns >= 0 && grid.rows >= 0 && grid.step_px > 0.0);
  std::vector<Vec2d> usable(position_px.begin(), position_px.end());
  for (std::size_t i = 0; i < usable.size(); ++i) {
    if (!std::isfinite(displacement_px[i].x) || !std::isfinite(displacement_px[i].y))
      usable[i] = {not_a_number, not_a_number};
  }
  double const smoothing = 0.6 * mean_spacing(usable);
  PointCells const cells(usable, 3.0 * smoothing);

  auto const value_at = [&](Vec2d node) {
    PlaneFit fit;
    for (double h = smoothing; h < 4.0 * smoothing; h *= 1.25) {
      fit = {};
      cells.for_near(node, 3.0 * h, [&](std::size_t i) {
        Vec2d const offset = (usable[i] - node) / h;
        double const r2 = dot(offset, offset);
        if (r2 <= 9.0) fit.add(offset, displacement_px[i], std::exp(-0.5 * r2));
      });
      if (fit.amplification() <= 1.0) return fit.at_node();
    }
    return fit.amplification() <= 4.0 ? fit.at_node() : Vec2d{not_a_number, not_a_number};
  };

  DisplacementMaps maps{Image<double>(grid.columns, grid.rows), Image<double>(grid.columns, grid.rows)};
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
    for (int column = 0; column < grid.columns; ++column) {
      Vec2d const node = grid.first_px + grid.step_px * Vec2d{static_cast<double>(column), static_cast<double>(row)};
      Vec2d const value = value_at(node);
      maps.u_px(column, static_cast<int>(row)) = value.x;
      maps.v_px(column, static_cast<int>(row)) = value.y;
    }
  });
  return maps;
}

}  // namespace gladstone::inline errors
