#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// Opens a list of the points of a regular grid, in any order: text with a header line that names the columns (CSV;
/// separated by commas, semicolons, tabs or blanks), or Tecplot ASCII. Columns x, y, z (or x_mm ...,
/// see coordinate_name()) are the coordinates, at least two of them; each other column is a field. Units are stated in
/// brackets after the name, or at its end: "rho [kg/m^3]", "rho_kg_m3". Columns u, v, w (or vx, vy, vz, or ux, uy, uz)
/// are also the field "velocity". The table is held in memory.
/// @throws DataError with file:line for rows that are not numbers, and for points that are missing or given twice
std::unique_ptr<CheckedSource> open_point_table(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone::inline files
