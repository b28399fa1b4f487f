#pragma once

#include <memory>

#include "render/base/fields/readers/checked_source.h"

namespace gladstone {

/// Opens an array of numbers in an HDF5 file, in any group or behind a link: a cut-out of the Johns Hopkins Turbulence
/// Databases as both of its clients write it ("density_0001" or "u00000" of shape [nz, ny, nx, values], coordinates
/// xcoor, ycoor, zcoor, rounded by the client to some decimals), netCDF-4, MATLAB 7.3, or a plain array.
///
/// - Shapes [nz, ny, nx] and [ny, nx], with further axes of length one anywhere; the components of a velocity are the
///   last axis or the first.
/// - Coordinates are those of netCDF's dimension scales, else datasets xcoor, x, X, x_mm, x_m, x_um ... in the group of
///   the array or above it, in the unit of their name or of their attribute "units". Without them spacings are 1.
/// - Axes are in the order that the caller names, else that of the dimension scales, else z, y, x where the lengths of
///   the coordinates allow it, else the only order that they allow.
/// @throws DataError for shapes that are no field, coordinates that do not fit, and filters that are not installed
std::unique_ptr<CheckedSource> open_hdf5(std::string const& path, FieldWish const& wish);

}  // namespace gladstone
