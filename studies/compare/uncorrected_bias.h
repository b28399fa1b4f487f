#pragma once

#include <string>

#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {

/// Returns the definition of the uncorrected bias, to follow "the uncorrected bias is NUMBER: ". It is the
/// window-averaged truth that the frames contain (Comparison::recorded()) minus theory (Eq. 9; for PIV, the flow). It
/// is neither corrected nor included in any uncertainty (JCGM 100:2008, F.2.4.5).
std::string describe_uncorrected_bias(ComparisonKind const& kind);

/// Returns the uncorrected bias of a comparison: rms over the compared vectors, per component [px].
double uncorrected_bias_px(Comparison const& comparison);

}  // namespace gladstone::inline compare
