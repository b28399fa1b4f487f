#pragma once

#include <span>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline errors {

/// Nodes of a map: node (column, row) is at first + (column step, row step), with rows downwards [px].
struct MapGrid {
  int columns = 0;
  int rows = 0;
  Vec2d first_px{};
  double step_px = 1.0;
};

/// Maps of the two components of displacement.
struct DisplacementMaps {
  Image<double> u_px;
  Image<double> v_px;
};

/// Interpolates scattered displacements onto a regular grid by local linear regression. At each node a plane is fitted
/// to the surrounding dots, weighted by exp(-r^2/(2 h^2)) within 3 h (Cleveland, J. Am. Stat. Assoc. 74 (1979) 829,
/// with a Gaussian kernel). Linear fields are reproduced exactly, inside and at the edges. h is 0.6 times the mean dot
/// spacing sqrt(area / count), which smooths about as much as linear interpolation between neighbours.
/// If a node is extrapolated (fewer than four dots, or a fit that amplifies the variance of the dots), h is increased
/// up to fourfold; if the fit with the largest h still amplifies the variance more than fourfold, the node is NaN.
/// @param position_px,displacement_px positions and displacements of the dots; dots with NaN are ignored
DisplacementMaps map_scattered(std::span<Vec2d const> position_px, std::span<Vec2d const> displacement_px,
                               MapGrid const& grid);

}  // namespace gladstone::inline errors
