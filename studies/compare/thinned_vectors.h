#pragma once

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline compare {

/// Returns the smallest step n such that every n-th vector of a lattice is at least `least_apart_px` from the next; 1
/// for vectors without a lattice.
int lattice_step(DisplacementField const& field, int least_apart_px);

/// Selects every n-th row and column of a lattice, centred as well as possible. Vectors without a lattice are
/// unchanged.
DisplacementField every_nth(DisplacementField field, int n);

}  // namespace gladstone::inline compare
