#pragma once

#include <span>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone {

/// Nodes of a map: node (column, row) lies at first + (column step, row step), row downwards [px].
struct MapGrid {
  int columns = 0;
  int rows = 0;
  Vec2d first_px{};
  double step_px = 1.0;
};

/// Maps of the two components of scattered displacements.
struct DisplacementMaps {
  Image<double> u_px;
  Image<double> v_px;
};

/// Interpolates scattered displacements onto a regular grid by local linear regression: at each node the plane that
/// fits the dots around it best, weighted by exp(-r^2/(2 h^2)) within 3 h (Cleveland, J. Am. Stat. Assoc. 74 (1979)
/// 829, with a Gaussian kernel). A linear field comes back exact, inside and at the edges. h is 0.6 of the mean dot
/// spacing sqrt(area / count), close to the smoothing of a linear interpolation between neighbours. Where that would
/// extrapolate (fewer than four dots, or a fit that amplifies the dots' errors), h grows up to fourfold, then the node
/// is NaN.
/// @param position_px,displacement_px of the dots; those with NaN are left out
/// @param smoothing_px h; 0: from the dot density
DisplacementMaps map_scattered(std::span<Vec2d const> position_px, std::span<Vec2d const> displacement_px,
                               MapGrid const& grid, double smoothing_px = 0.0);

}  // namespace gladstone
