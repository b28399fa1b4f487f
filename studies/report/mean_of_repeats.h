#pragma once

#include <cstddef>
#include <vector>

#include "render/base/displacement_field.h"

namespace gladstone {

/// What the repeats of a measurement tell of its mean (JCGM 100:2008, 4.2), beside what is known of each of them.
struct MeanOfRepeats {
  DisplacementField field;  ///< of the mean, with its standard deviation for uncertainty; of one measurement as it is
  std::size_t count = 1;
  double estimated_px = 0;  ///< the mean's uncertainty by what every measurement says of itself, median over components
};

/// The mean of several measurements at the same vectors, those that count in all of them.
/// @param all        with the first's places, one or more
/// @param formula_px random error of one that does not say
MeanOfRepeats mean_of_repeats(std::vector<DisplacementField> const& all, double formula_px);

}  // namespace gladstone
