#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "render/files/hdf5_file.h"
#include "render/scene/renderer.h"

namespace gladstone::inline cases {

/// Writes truth.h5 of PIV: /particles and /rays (docs/file-formats.md).
void write_particle_truth(std::string const& path, Scene const& scene, Rendering const& rendering,
                          FileOrigin const& origin);

/// Returns the entries of summary.json that only PIV has: numbers of particles, of illuminated ones and of those in
/// view, their light, and the accuracy of their paths.
/// @param exposure_e  electrons released by one unit of light [e]
nlohmann::json particle_summary(Scene const& scene, GroundTruth const& truth, double exposure_e);

/// Reads the particles of a truth.h5.
/// @throws DataError if the file is invalid
GroundTruth read_particle_truth(std::string const& path);

}  // namespace gladstone::inline cases
