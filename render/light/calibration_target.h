#pragma once

#include <vector>

#include "render/light/target_setup.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Table [calibration] of a setup, in SI: a square lattice of dots, recorded on several planes perpendicular to Z. The
/// central dot is on the Z axis.
struct CalibrationTarget {
  std::vector<double> planes;  ///< Z of the planes, ascending [m]
  TargetSetup target;          ///< target of kind TargetKind::lattice
};

CalibrationTarget read_calibration_target(SetupTable table);

/// Dots of a square lattice: dot (i, j) is at spacing (i, j), i = -half_columns ... half_columns along X, j =
/// -half_rows ... half_rows along Y.
struct Lattice {
  int half_columns = 0, half_rows = 0;
  double spacing = 0;  ///< distance between neighbouring dots [m]

  /// Creates the largest lattice whose dot centres are within the target's extent.
  explicit Lattice(TargetSetup const& target);
  std::size_t size() const {
    return static_cast<std::size_t>(2 * half_columns + 1) * static_cast<std::size_t>(2 * half_rows + 1);
  }
  /// Column i and row j of dot k; dots are numbered along X first.
  int column(std::size_t k) const {
    return static_cast<int>(k % static_cast<std::size_t>(2 * half_columns + 1)) - half_columns;
  }
  int row(std::size_t k) const {
    return static_cast<int>(k / static_cast<std::size_t>(2 * half_columns + 1)) - half_rows;
  }
  /// Returns the dot centres [m].
  std::vector<Vec2d> dots() const;
};

}  // namespace gladstone::inline light
