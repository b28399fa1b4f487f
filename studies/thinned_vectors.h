#pragma once

#include "render/base/displacement_field.h"

namespace gladstone {

/// Which of a lattice's vectors along rows and columns are at least so far apart: 1 all, 2 every second ...; 1 where
/// there is no lattice.
int lattice_step(DisplacementField const& field, int least_apart_px);

/// Every n-th row and column of a lattice, as near to its middle as they come. A field without a lattice stays.
DisplacementField every_nth(DisplacementField field, int n);

}  // namespace gladstone
