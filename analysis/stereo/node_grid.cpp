#include "analysis/stereo/node_grid.h"

#include <cmath>

namespace gladstone::inline stereo {

NodeGrid NodeGrid::between(Vec2d low, Vec2d high, double spacing) {
  constexpr double max_nodes = 1e5;
  if (!(spacing > 0.0)) return {};
  double const left = std::ceil(low.x / spacing), right = std::floor(high.x / spacing);
  double const bottom = std::ceil(low.y / spacing), top = std::floor(high.y / spacing);
  if (!(left <= right && bottom <= top && right - left < max_nodes && top - bottom < max_nodes)) return {};
  return {static_cast<int>(right - left) + 1, static_cast<int>(top - bottom) + 1, spacing * Vec2d{left, bottom},
          spacing};
}

}  // namespace gladstone::inline stereo
