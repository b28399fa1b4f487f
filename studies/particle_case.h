#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "render/base/hdf5_file.h"
#include "render/scene/ground_truth.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Writes truth.h5 of PIV: /particles and /rays (docs/file-formats.md).
void write_particle_truth(std::string const& path, Scene const& scene, GroundTruth const& truth,
                          StatusCounts const& statuses, RenderMethod method, FileOrigin const& origin);

/// What summary.json says of particles beside what it says of dots: how many there are, are lit and in view, their
/// light, and how well their paths are known.
/// @param exposure_e electrons that light of 1 sets free
nlohmann::json particle_summary(Scene const& scene, GroundTruth const& truth, double exposure_e);

/// Reads the particles of a truth.h5 back. @throws DataError
GroundTruth read_particle_truth(std::string const& path);

}  // namespace gladstone
