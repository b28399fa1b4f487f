#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/fields/field_file.h"
#include "render/light/flows/file.h"

namespace gladstone {

/// What [flow] with kind = "file" says, in SI.
struct VelocityFile {
  std::string file, dataset;
  std::string axes;              ///< world axes in the file's order, the slowest first; empty: as the file has them
  std::string where;             ///< of the key `file`, for messages
  double scale = 1;              ///< file value times scale = m/s
  std::optional<Vec3d> spacing;  ///< of nodes, in place of the file's own [m]
  Vec3d center{};                ///< of the grid in the world [m]
  bool extrude = false;          ///< a single plane: the same along Z
  std::array<bool, 3> periodic{};
};

/// Where the nodes of a file's velocity stand in the world; opens the file to see its grid.
/// @throws DataError for files that are missing, broken or of the wrong shape
RegularGrid velocity_grid(VelocityFile const& setup);

/// Memory that the velocity of a file takes [bytes].
double velocity_bytes(VelocityFile const& setup);

/// A velocity in memory.
struct LoadedVelocity {
  std::shared_ptr<std::vector<float> const> coefficients;
  FileFlow flow;        ///< sees them
  std::string warning;  ///< what had to be assumed or ignored of the file; empty: nothing
};

/// Reads a velocity and turns it into the coefficients of cubic B-splines, not-a-knot at open ends (as media have it):
/// they reproduce cubics up to the ends. Coefficients are floats: 1e-7 of the largest velocity.
/// @throws DataError, MemoryError
LoadedVelocity load_velocity(VelocityFile const& setup);

}  // namespace gladstone
