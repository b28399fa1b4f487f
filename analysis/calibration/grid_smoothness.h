#pragma once

#include <vector>

#include "analysis/calibration/grid_assignment.h"

namespace gladstone::inline calibration {

/// Dots of one plane after removal of spots that do not belong to the grid.
struct SmoothGrid {
  std::vector<GridDot> dots;
  std::vector<Vec2d> strangers;  ///< removed spots [px]
  double rms_px = 0;             ///< rms residual of the dot positions per component; 0: too few dots
};

/// Removes spots whose position or diameter is inconsistent with the other dots of a plane. Because a lens images a
/// grid smoothly, the positions are fitted by a cubic polynomial in (i, j) (a quadratic one below 30 dots) and the
/// diameters by a linear one. Fewer than 15 dots are returned unchanged. A spot is removed if its residual exceeds six
/// robust standard deviations and also
/// - for the position: a fiftieth of the spacing,
/// - for the diameter: a quarter of the median diameter and 1 px.
/// The robust standard deviation is the median of the residuals divided by 1.1774 for positions (Rayleigh
/// distribution), and the median times 1.4826 for diameters (normal distribution).
SmoothGrid remove_inconsistent_spots(std::vector<GridDot> dots);

}  // namespace gladstone::inline calibration
