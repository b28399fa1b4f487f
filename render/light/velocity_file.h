#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/field_file.h"
#include "render/light/flows/file.h"

namespace gladstone::inline light {

/// Keys of table [flow] with kind = "file", in SI.
struct VelocityFile {
  std::string file, dataset;
  std::string axes;              ///< world axes in the file's order, slowest first ("zyx"); empty: defined by the file
  std::string where;             ///< location of the key `file` in the setup, for messages
  std::optional<double> scale;   ///< factor from file values to velocities in m/s; nullopt: by the file's unit
  std::optional<Vec3d> spacing;  ///< node spacing [m]; empty: as in the file
  Vec3d center{};                ///< world position of the grid's centre [m]
  bool extrude = false;          ///< true: the file contains a single plane, and the velocity does not depend on Z
  std::array<bool, 3> periodic{};
};

/// Returns the grid of a velocity file in world coordinates; opens the file and reads its header.
/// @throws DataError if the file is missing or broken, or has an unsuitable shape
RegularGrid velocity_grid(VelocityFile const& setup);

/// Returns the memory required for the coefficients of a velocity file [bytes].
double velocity_bytes(VelocityFile const& setup);

/// Velocity field in memory.
struct LoadedVelocity {
  std::shared_ptr<std::vector<float> const> coefficients;
  FileFlow flow;      ///< view of `coefficients`
  Warnings warnings;  ///< assumptions made in reading the file, and data that were ignored
};

/// Reads a velocity file and computes the coefficients of a cubic B-spline through its nodes. Open axes have not-a-knot
/// end conditions, as in the medium, so that cubics are reproduced up to the boundary. Coefficients are stored as
/// float, which limits the relative accuracy to 1e-7 of the largest velocity.
/// @throws DataError
LoadedVelocity load_velocity(VelocityFile const& setup);

}  // namespace gladstone::inline light
