#pragma once

#include <string>

#include "studies/compare.h"

namespace gladstone {

/// What is meant by uncorrected bias wherever it is told, to stand behind "the uncorrected bias is NUMBER: ": truth
/// that the frames hold of the window (Comparison::recorded()) less theory (Eq. 9, of PIV the flow). It is neither
/// corrected nor in any uncertainty (JCGM 100:2008, F.2.4.5).
std::string uncorrected_bias_words(BudgetChain chain);

/// That of a comparison: rms over the vectors that count, per component [px].
double uncorrected_bias_px(Comparison const& comparison);

}  // namespace gladstone
