#pragma once

#include <string>

#include "render/files/hdf5_file.h"
#include "render/scene/field_map.h"
#include "render/scene/renderer.h"

namespace gladstone::inline cases {

/// Spacing of the maps of /field [px]; turbulent fronts are a few pixels wide.
inline constexpr int truth_map_spacing_px = 2;

/// Writes truth.h5: /dots, /rays, /field (docs/file-formats.md).
/// @param table  measured errors of the deflection table; null: no table was used
void write_truth(std::string const& path, Scene const& scene, Rendering const& rendering, FieldMap const& field,
                 TableError const* table, FileOrigin const& origin);

/// Reads the dots, or the particles, of a truth.h5.
/// @throws DataError if the file is invalid
GroundTruth read_truth(std::string const& path);

/// Reads the maps of /field.
FieldMap read_field_map(std::string const& path);

}  // namespace gladstone::inline cases
