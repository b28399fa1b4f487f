#pragma once

#include "render/base/fields/field_file.h"
#include "render/base/vec.h"

namespace gladstone {

/// What the numbers of a field range over, in the units of its file.
struct FieldStatistics {
  double minimum = 0;
  double maximum = 0;
  Vec3d steepest{};  ///< largest difference between neighbours along x, y, z, per unit length
};

/// Reads a field through, block by block: of whatever size it is, some 100 MB of it are held. Tells its progress.
/// @throws DataError as FieldSource, and for rows that do not fit into memory; Interrupted
FieldStatistics field_statistics(FieldSource& source);

}  // namespace gladstone
