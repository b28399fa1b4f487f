#pragma once

#include "analysis/vectors/scale_and_shift.h"

namespace gladstone::inline vectors {

/// Searches for positions with another origin: finds the shift that fits best among multiples of 4 px up to 64 px, and
/// refines it by least squares.
ProbableMistake find_shift(Search const& search);

/// Searches for positions that are a multiple of the true positions, for example in another unit.
ProbableMistake find_place_factor(Search const& search);

}  // namespace gladstone::inline vectors
