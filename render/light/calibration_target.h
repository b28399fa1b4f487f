#pragma once

#include <vector>

#include "render/base/setup_table.h"
#include "render/light/target_setup.h"

namespace gladstone {

/// Table [calibration] of a setup, in SI: a square lattice of dots that is shown to the camera on one plane after the
/// other, square to Z, its middle dot on the Z axis.
struct CalibrationTarget {
  std::vector<double> planes;  ///< Z of each [m]
  TargetSetup target;          ///< of TargetKind::lattice
};

CalibrationTarget read_calibration_target(SetupTable table);

/// The dots of a lattice: (i, j) times the spacing, i along X from -half_columns to half_columns and j along Y
/// likewise.
struct Lattice {
  int half_columns = 0, half_rows = 0;
  double spacing = 0;  ///< [m]

  /// As many dots as have their centres on the target's extent, one of them on its middle.
  explicit Lattice(TargetSetup const& target);
  std::size_t size() const {
    return static_cast<std::size_t>(2 * half_columns + 1) * static_cast<std::size_t>(2 * half_rows + 1);
  }
  /// Column of dot k; its row. Dots are counted along X first.
  int column(std::size_t k) const {
    return static_cast<int>(k % static_cast<std::size_t>(2 * half_columns + 1)) - half_columns;
  }
  int row(std::size_t k) const {
    return static_cast<int>(k / static_cast<std::size_t>(2 * half_columns + 1)) - half_rows;
  }
  /// Their centres [m].
  std::vector<Vec2d> dots() const;
};

}  // namespace gladstone
