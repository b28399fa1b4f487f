#pragma once

#include <vector>

#include "analysis/calibration/dot_detection.h"

namespace gladstone {

/// The dots of a calibration target: (i, j) times the spacing, from -half_columns and -half_rows to as many.
struct CalibrationGrid {
  int half_columns = 0, half_rows = 0;
  double spacing = 0;       ///< [m]
  double dot_diameter = 0;  ///< [m]
};

/// Roughly how a camera is expected to see the grid of a plane.
struct ExpectedView {
  Vec2d middle_px{};                 ///< of the grid
  Vec2d along_x_px{}, along_y_px{};  ///< from a dot to the next along X and along Y
};

/// A detected dot with its place on the grid.
struct GridDot {
  int i = 0, j = 0;
  Vec2d pixel{};
};

/// How the grid's middle was told among dots that all look alike.
enum class MiddleBy {
  whole_grid,     ///< all columns and rows are in view
  expected_view,  ///< the dot nearest to where the middle is expected
};

struct AssignedDots {
  std::vector<GridDot> dots;
  MiddleBy middle_by = MiddleBy::whole_grid;
};

/// Gives dots their places on the grid: from the dot nearest to the middle of all, from neighbour to neighbour, each
/// step foretold by the one before it. The expected view tells which way X and Y run, within 45 degrees; where the
/// picture shows a part of the grid only, also which dot the middle is, within half a spacing. Dots that lie off the
/// grid are left out.
AssignedDots assign_to_grid(std::vector<DetectedDot> const& dots, CalibrationGrid const& grid,
                            ExpectedView const& expected);

}  // namespace gladstone
