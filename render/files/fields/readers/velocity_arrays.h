#pragma once

#include <memory>
#include <string>

#include "render/files/fields/readers/array_file.h"

namespace gladstone::inline files {

/// Joins arrays of velocity components to arrays of vectors: u, v, w (or vx, vy, vz; ux, uy, uz; in upper or lower
/// case, with or without a unit, "u_m_s") of one group and of equal shape become "velocity", [..., 3], in that group,
/// and are no longer listed by names(). Without the third component it is 0, with a note.
/// @throws DataError, when units are asked for, if the components have different ones
std::unique_ptr<ArrayFile const> join_velocities(std::unique_ptr<ArrayFile const> file, std::string const& path);

}  // namespace gladstone::inline files
