#pragma once

#include "render/base/warning.h"
#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Rms true displacement per component below which correlation cannot be expected to measure a signal [px].
inline constexpr double least_signal_px = 0.01;

/// Returns warnings that limit the validity of a comparison: peak locking from small dot images, and true displacements
/// below least_signal_px or below the vectors' error.
Warnings comparison_warnings(Comparison const& comparison, Setup const& setup);

}  // namespace gladstone::inline compare
