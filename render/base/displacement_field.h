#pragma once

#include <cstddef>
#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// What a measured vector is worth; the numbers are those of vectors.h5 and vectors.csv.
enum class VectorStatus : int { valid = 0, replaced = 1, masked = 2, invalid = 3 };

/// Displacements at scattered or gridded points: one type for truth, theory and measurement.
/// Positions and displacements in px; column x to the right, row y downwards, displacement = flow - reference.
struct DisplacementField {
  std::vector<Vec2d> position_px;
  std::vector<Vec2d> displacement_px;
  std::vector<Vec2d> sigma_px;       ///< standard uncertainty, NaN where not estimated; empty: none
  std::vector<double> peak_ratio;    ///< highest over second correlation peak; empty: none
  std::vector<VectorStatus> status;  ///< empty: all valid
  int columns = 0;                   ///< vectors in a row of the interrogation grid, row by row; 0: scattered
  int rows = 0;

  std::size_t size() const { return position_px.size(); }
  /// True for vectors that count in statistics (valid or replaced).
  bool counts(std::size_t i) const {
    return status.empty() || status[i] == VectorStatus::valid || status[i] == VectorStatus::replaced;
  }
};

}  // namespace gladstone
