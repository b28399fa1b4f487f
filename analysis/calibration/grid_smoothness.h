#pragma once

#include <vector>

#include "analysis/calibration/grid_assignment.h"

namespace gladstone {

/// The dots of one plane without those that do not belong to its grid.
struct SmoothGrid {
  std::vector<GridDot> dots;
  std::vector<Vec2d> strangers;  ///< what was removed [px]
  double rms_px = 0;             ///< residuals of the dots' places, per component; 0: too few dots to say
};

/// Removes spots whose place or diameter does not fit the others' of a plane: lenses image a grid smoothly, so that the
/// places follow a cubic polynomial in (i, j) (a quadratic one below 30 dots; fewer than 15 are returned as they are),
/// and diameters a linear one. Removed are residuals of more than six robust standard deviations (1.4826 times the
/// median) that exceed a fiftieth of a spacing, or a quarter of a diameter and 1 px.
SmoothGrid remove_strangers(std::vector<GridDot> dots);

}  // namespace gladstone
