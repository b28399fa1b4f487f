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
  double diameter_px = 0;
};

/// How the grid's middle was told among dots that all look alike.
enum class MiddleBy {
  whole_grid,     ///< all columns and rows are in view
  expected_view,  ///< the dot nearest to where the middle is expected, along X, Y or both
};

struct AssignedDots {
  std::vector<GridDot> dots;
  MiddleBy middle_by = MiddleBy::whole_grid;
  double middle_offset = 0;      ///< of the expected middle from the dot taken for it, the larger component [spacings]
  int columns = 0, rows = 0;     ///< that the dots span; more than the grid has where the grid is larger than told
  std::vector<Vec2d> strangers;  ///< spots with a place on the grid that are no dots of it, see remove_strangers() [px]
  double smoothness_px = 0;      ///< rms per component of the dots about a smooth grid: noise, or more; 0: unknown
};

/// Gives dots their places on the grid: from the dot nearest to the middle of all, from neighbour to neighbour, each
/// step foretold by the one before it. The expected view tells which way X and Y run, within 45 degrees; along an axis
/// on which the picture shows a part of the grid only, also which dot the middle is, within half a spacing. Spots that
/// lie off the grid are left out.
AssignedDots assign_to_grid(std::vector<DetectedDot> const& dots, CalibrationGrid const& grid,
                            ExpectedView const& expected);

}  // namespace gladstone
