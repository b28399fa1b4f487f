#pragma once

#include <string>
#include <vector>

#include "studies/compare.h"

namespace gladstone {

/// Displacement below which a field has no signal that correlation could be expected to show, rms per component [px].
inline constexpr double least_signal_px = 0.01;

/// What is to be known before the numbers of a comparison are believed: images so small that they lock to the pixels,
/// and true displacements below least_signal_px or below the vectors' error.
std::vector<std::string> comparison_warnings(Comparison const& comparison, Setup const& setup);

}  // namespace gladstone
