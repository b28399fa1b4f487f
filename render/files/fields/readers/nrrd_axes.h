#pragma once

#include "render/files/fields/readers/nrrd_fields.h"
#include "render/files/fields/readers/nrrd_header.h"

namespace gladstone::inline files {

/// Returns the header with the properties of its axes: dimension, sizes, axes, units, notes, directed and labelled.
/// Axes of components and superfluous axes of one node are dropped; the others are placed by "space directions", or
/// else by "spacings" or "axis mins" and "axis maxs".
/// @param values  number of values per node
/// @throws DataError if the axes are not those of a field in two or three dimensions along the world axes
NrrdHeader with_nrrd_axes(NrrdHeader header, NrrdFields const& fields, int values);

}  // namespace gladstone::inline files
