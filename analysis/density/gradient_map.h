#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline density {

/// Regular grid of nodes in the medium's mid-plane, stored row by row: node (column, row) is at origin +
/// (column spacing.x, row spacing.y) with x to the right and y up, so that row 0 is the lowest row.
struct PlaneGrid {
  int columns = 0;
  int rows = 0;
  Vec2d origin{};           ///< position of node (0, 0) [m]
  Vec2d spacing{1.0, 1.0};  ///< distance between nodes [m], positive

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  bool contains(int column, int row) const { return column >= 0 && column < columns && row >= 0 && row < rows; }
  Vec2d position(int column, int row) const { return {origin.x + column * spacing.x, origin.y + row * spacing.y}; }
};

/// Gradient of the density on a grid, either projected, i.e. integrated along the line of sight [kg/m^3], or averaged
/// over the thickness of the medium [kg/m^4].
struct GradientMap {
  PlaneGrid grid;
  std::vector<Vec2d> gradient;      ///< gradient (d/dx, d/dy) of every node [grid.size()]; ignored at invalid nodes
  std::vector<Vec2d> sigma;         ///< standard uncertainty, unit of `gradient` [grid.size()]; empty: unknown
  std::vector<std::uint8_t> valid;  ///< 1: measured, 0: hole or masked [grid.size()]
  bool is_valid(int column, int row) const { return grid.contains(column, row) && valid[grid.index(column, row)] != 0; }
};

/// Checks a gradient map that comes from a user's data.
/// @throws DataError  if the grid has fewer than 2 x 2 nodes, the arrays differ in length, no node is valid, or the
///                    gradient or its sigma is not finite (sigma: not positive) at a valid node
void check_gradient_map(GradientMap const& map);

}  // namespace gladstone::inline density
