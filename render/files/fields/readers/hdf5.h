#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone {

/// Opens a numeric array in an HDF5 file, in any group or behind a link: a cut-out of the Johns Hopkins Turbulence
/// Databases as written by either client ("density_0001" or "u00000" of shape [nz, ny, nx, values], with coordinates
/// xcoor, ycoor, zcoor rounded to a few decimals), netCDF-4, MATLAB 7.3, or a plain array.
///
/// - Shapes: [nz, ny, nx] or [ny, nx], with additional axes of length one at any place; the components of a velocity
///   are the last or the first axis.
/// - Coordinates: the dimension scales of netCDF-4, else datasets xcoor, x, X, x_mm, x_m, x_um ... in the group of the
///   array or above it, in the unit of their name or of their attribute "units". They have one axis, or the shape of
///   the field (meshgrid) and vary along one axis. Coordinates of n + 1 edges along each axis make the field one of
///   cells. Without coordinates the spacing is 1.
/// - Order of axes: that of the caller, else that of the dimension scales, else that of the dimension labels, else that
///   of coordinates of the shape of the field, else z, y, x if the lengths of the coordinates allow it, else the only
///   order that they allow.
/// - Values: attributes scale_factor, add_offset, _FillValue and missing_value (CF Conventions) are applied; missing
///   values become NaN.
/// @throws DataError for shapes that are not a field, coordinates of the wrong length or of a curved grid, and missing
/// compression filters
std::unique_ptr<CheckedSource> open_hdf5(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone
