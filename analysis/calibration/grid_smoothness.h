#pragma once

#include <vector>

#include "analysis/calibration/grid_assignment.h"

namespace gladstone {

/// Dots of one plane after removal of spots that do not belong to the grid.
struct SmoothGrid {
  std::vector<GridDot> dots;
  std::vector<Vec2d> strangers;  ///< removed spots [px]
  double rms_px = 0;             ///< rms residual of the dot positions per component; 0: too few dots
};

/// Removes spots whose position or diameter is inconsistent with the other dots of a plane. Lenses image a grid
/// smoothly: positions are fitted by a cubic polynomial in (i, j) (quadratic below 30 dots; fewer than 15 dots are
/// returned unchanged), diameters by a linear one. A spot is removed if its residual exceeds six robust standard
/// deviations and
/// - for the position: a fiftieth of the spacing,
/// - for the diameter: a quarter of the median diameter and 1 px.
/// The robust standard deviation follows from the median of the residuals: divided by 1.1774 for positions (Rayleigh
/// distribution), times 1.4826 for diameters (normal distribution).
SmoothGrid remove_inconsistent_spots(std::vector<GridDot> dots);

}  // namespace gladstone
