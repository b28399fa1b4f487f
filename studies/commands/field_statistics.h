#pragma once

#include <vector>

#include "render/base/vec.h"
#include "render/files/fields/field_file.h"

namespace gladstone::inline commands {

/// Extremes of one component of a field and of its gradient, in the units of its file.
struct FieldStatistics {
  double minimum = 0;
  double maximum = 0;
  Vec3d steepest{};  ///< largest absolute difference of neighbouring nodes along x, y, z, per unit length
};

/// Reads a field block by block and computes the statistics of each component, one for a scalar field; about 100 MB are
/// held in memory for a field of any size. Reports its progress.
/// @throws DataError as FieldSource, and if a row does not fit into memory
/// @throws Interrupted if the user interrupts the command
std::vector<FieldStatistics> field_statistics(FieldSource& source);

}  // namespace gladstone::inline commands
