#pragma once

#include "analysis/vectors/scale_and_shift.h"

namespace gladstone::detail {

/// Searches for positions with another origin: the shift that fits best, on a lattice of 4 px up to 64 px, refined by
/// least squares.
ProbableMistake find_shift(Search const& search);

/// Searches for positions that are a multiple of the true ones.
ProbableMistake find_place_factor(Search const& search);

}  // namespace gladstone::detail
