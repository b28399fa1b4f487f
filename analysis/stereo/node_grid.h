#pragma once

#include <cstddef>

#include "render/base/vec.h"

namespace gladstone::inline stereo {

/// Regular grid of nodes with z on the object plane, row by row from the smallest y.
struct NodeGrid {
  int columns = 0, rows = 0;
  Vec2d first{};         ///< x and y of the first node [m]
  double spacing = 0.0;  ///< distance between nodes along x and y [m]

  /// Returns the grid of all nodes between two corners whose coordinates are multiples of the spacing; empty if no
  /// multiple lies between them, or more than 1e5 do along an axis.
  static NodeGrid between(Vec2d low, Vec2d high, double spacing);

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  Vec2d position(std::size_t node) const {
    auto const width = static_cast<std::size_t>(columns);
    std::size_t const column = node % width, row = node / width;
    return first + spacing * Vec2d{static_cast<double>(column), static_cast<double>(row)};
  }
  /// Converts between x and y on the plane [m] and the position in an image of the nodes, whose row 0 shows the largest
  /// y [px].
  Vec2d pixel(Vec2d at) const { return {(at.x - first.x) / spacing, rows - 1 - (at.y - first.y) / spacing}; }
  Vec2d position_of_pixel(Vec2d pixel) const { return first + spacing * Vec2d{pixel.x, rows - 1 - pixel.y}; }
};

}  // namespace gladstone::inline stereo
