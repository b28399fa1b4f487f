#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case/result_rows.h"
#include "studies/compare/tomography.h"

namespace gladstone::inline compare {

/// Writes a reconstructed volume as HDF5 (docs/file-formats.md). Its dataset density_kg_m3 can be the medium.field.file
/// of a setup. Another ending than .h5 selects one of the formats of write_grid_table(), with the quantities at the
/// nodes.
void write_tomography(std::string const& path, Tomography const& result);

/// Returns the quantities of a reconstruction: those of the volume, then those of each view.
std::vector<ResultRow> tomography_rows(Tomography const& result);

/// Summarises a reconstruction as JSON.
nlohmann::ordered_json summarize_tomography(Tomography const& result);

/// Formats the summary as text.
std::string tomography_report(Tomography const& result);

/// Returns the position of the middle of a grid, which is `center_mm` of a field [m].
Vec3d find_grid_centre(RegularGrid const& grid);

/// Writes a volume of densities with the coordinates of its nodes: /x_mm, /y_mm, /z_mm and /density_kg_m3.
/// @param density  [kg/m^3, grid.size()], x fastest
/// @param setup    text of the setup that the volume derives from
void write_density_volume(std::string const& path, RegularGrid const& grid, std::vector<double> const& density,
                          std::string const& setup);

}  // namespace gladstone::inline compare
