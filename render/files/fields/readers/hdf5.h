#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// Opens a numeric array in an HDF5 file, in any group or behind a link, as open_array_field() describes: a cut-out of
/// the Johns Hopkins Turbulence Databases as written by either client ("density_0001" or "u00000" of shape [nz, ny, nx,
/// values], with coordinates xcoor, ycoor, zcoor rounded to a few decimals), netCDF-4, MATLAB 7.3, or a plain array.
/// @throws DataError as open_array_field(), and for missing compression filters
std::unique_ptr<CheckedSource> open_hdf5(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone::inline files
