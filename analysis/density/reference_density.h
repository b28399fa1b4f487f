#pragma once

#include <vector>

#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Nodes of known density. They fix the constant of an integration and are its Dirichlet boundary condition.
struct ReferenceDensity {
  /// Known density [grid.size()], in the unit of the gradient times m; NaN: not a reference node.
  std::vector<double> value;
  double sigma = 0.0;  ///< standard uncertainty common to all reference nodes, unit of `value`
};

enum class GridSide { left, right, bottom, top };

/// Creates a reference with the density `value` at all nodes within the rectangle from `low` to `high` [m], borders
/// included.
/// @throws SetupError  if the value is not finite, sigma is negative, or no node lies within the rectangle
ReferenceDensity make_box_reference(PlaneGrid const& grid, Vec2d low, Vec2d high, double value, double sigma = 0.0);

/// Creates a reference with the density `value` along one side of the grid.
/// @param depth  number of columns or rows, from 1
/// @throws SetupError  if the value is not finite, sigma is negative, or the depth is not within the grid
ReferenceDensity make_side_reference(PlaneGrid const& grid, GridSide side, double value, int depth = 1,
                                     double sigma = 0.0);

/// Combines two references. At nodes that both contain, the value of `b` is used. The larger sigma is used for all
/// nodes.
/// @pre both references belong to the same grid
ReferenceDensity combine_references(ReferenceDensity a, ReferenceDensity const& b);

}  // namespace gladstone::inline density
