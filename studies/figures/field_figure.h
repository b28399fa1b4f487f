#pragma once

#include "render/files/fields/field_file.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Values of a field, or the magnitude of a velocity, in the planes through its middle nodes, in the unit of the file:
/// z = const, y = const and x = const, with a common colour scale. Axes are in mm, or numbers of nodes if the spacing
/// is unknown. Planes with a single node along an axis are omitted. Reads the field plane by plane and reports its
/// progress.
/// @param lengths_known  the file's spacing and unit of length are defined along all axes
/// @throws DataError if the field cannot be read, or if no plane has two nodes along both axes
/// @throws Interrupted
Figure make_field_figure(FieldSource& source, bool lengths_known);

}  // namespace gladstone::inline figures
