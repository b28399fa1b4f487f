#pragma once

#include <vector>

#include "analysis/calibration/dot_detection.h"

namespace gladstone::inline calibration {

/// Grid of dots on a calibration target: dot (i, j) is at (i, j) times the spacing, with |i| <= half_columns and |j| <=
/// half_rows.
struct CalibrationGrid {
  int half_columns = 0, half_rows = 0;
  double spacing = 0;       ///< distance between neighbouring dots [m]
  double dot_diameter = 0;  ///< diameter of a dot [m]
};

/// Approximate image of the grid of one plane, as expected from the camera set-up.
struct ExpectedView {
  Vec2d middle_px{};                 ///< image of the grid's centre
  Vec2d along_x_px{}, along_y_px{};  ///< image vector from a dot to its neighbour along X and along Y
};

/// Detected dot with its grid index.
struct GridDot {
  int i = 0, j = 0;
  Vec2d pixel{};
  double diameter_px = 0;
};

/// Method by which the centre dot of the grid was identified among the identical dots.
enum class CentreDotMethod {
  whole_grid,     ///< all columns and rows of the grid are visible, so that its middle dot is the centre dot
  expected_view,  ///< along X, Y or both, the centre dot is the one nearest to the expected image of the grid's centre
};

struct AssignedDots {
  std::vector<GridDot> dots;
  CentreDotMethod middle_by = CentreDotMethod::whole_grid;
  /// Distance of the expected centre from the chosen centre dot, larger component [spacings].
  double middle_offset = 0;
  /// Numbers of visible columns and rows; larger than those of `grid` if the target has more dots than specified.
  int columns = 0, rows = 0;
  /// Detected spots with a grid index that are not dots of the grid, see remove_inconsistent_spots() [px].
  std::vector<Vec2d> strangers;
  /// RMS residual of the dot positions per component after the fit of a smooth grid: contains noise and distortions of
  /// high order [px]; 0: unknown.
  double smoothness_px = 0;
};

/// Assigns grid indices to dots. The search starts at a dot near the centroid of all dots and proceeds from neighbour
/// to neighbour, predicting each step from the previous one. The expected view determines the directions of X and Y, to
/// within 45 degrees. If only a part of the grid is visible along an axis, the expected view also determines the centre
/// dot, to within half a spacing. Spots off the grid are excluded.
AssignedDots assign_to_grid(std::vector<DetectedDot> const& dots, CalibrationGrid const& grid,
                            ExpectedView const& expected);

}  // namespace gladstone::inline calibration
