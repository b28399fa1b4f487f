#pragma once

#include <string>

#include "render/base/hdf5_file.h"
#include "render/scene/field_map.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_plan.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Writes truth.h5: /dots, /rays, /field (docs/file-formats.md).
/// @param table what a deflection table leaves, by measurement; null: none was used
void write_truth(std::string const& path, Scene const& scene, GroundTruth const& truth, StatusCounts const& statuses,
                 FieldMap const& field, RenderMethod method, RaysPlan const* table, FileOrigin const& origin);

/// Reads the dots of a truth.h5 back. @throws DataError
GroundTruth read_truth(std::string const& path);

/// Reads the maps of /field back.
FieldMap read_field_map(std::string const& path);

}  // namespace gladstone
