#pragma once

#include <cstddef>
#include <vector>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline report {

/// Mean of repeated measurements with its type A uncertainty (JCGM 100:2008, 4.2), and the individual estimates.
struct MeanOfRepeats {
  DisplacementField field;  ///< mean, with its standard deviation as uncertainty; a single measurement is unchanged
  std::size_t count = 1;
  /// uncertainty of the mean from the estimates of the individual measurements, median over components [px]
  double estimated_px = 0;
};

/// Averages several measurements over the vectors that are valid in all of them.
/// @param all         one or more measurements at the same positions
/// @param formula_px  random error of a measurement without uncertainties [px]
MeanOfRepeats mean_of_repeats(std::vector<DisplacementField> const& all, double formula_px);

}  // namespace gladstone::inline report
