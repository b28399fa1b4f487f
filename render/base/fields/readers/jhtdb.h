#pragma once

#include <memory>
#include <string>

#include "render/base/fields/field_file.h"

namespace gladstone {

/// Opens a cut-out of the Johns Hopkins Turbulence Databases (HDF5), as both of its clients write it:
/// - the present one (giverny, givernylocal; netCDF-4): a dataset "density_0001" of shape [nz, ny, nx, values] with
///   coordinates xcoor, ycoor, zcoor, rounded by the client to some decimals;
/// - the older one (pyJHTDB and the cut-out service): "Density_0001" or "u00000" of shape [nz, ny, nx, components],
///   with or without coordinates, beside small datasets of the request;
/// and a plain [nz, ny, nx]. Numbers of any type are read as float.
///
/// Spacing and origin are those of the coordinates, in the unit that their attribute "units" names; without them 1 and
/// 0. An axis of one node takes the spacing of x. Axes must ascend and be uniform to 1e-4 of a step, beyond what float
/// coordinates can tell.
/// @param dataset empty: the only one that holds a field of so many values a point
/// @param values 1 of a scalar field, 3 of a velocity
/// @throws DataError for a wrong rank, another number of values a point, axes that are not uniform or do not fit
std::unique_ptr<FieldSource> open_jhtdb(std::string const& path, std::string const& dataset, int values);

}  // namespace gladstone
