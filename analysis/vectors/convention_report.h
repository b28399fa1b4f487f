#pragma once

#include <string>

#include "analysis/vectors/convention_detection.h"

namespace gladstone::inline vectors {

/// Returns the report for vectors that no convention fits: the tried interpretations and the probable cause.
std::string misfit_report(VectorFile const& file, DetectedConventions const& detected);

/// Returns one line about the conventions in use, their fit, and the best other interpretation.
std::string found_report(VectorFile const& file, DetectedConventions const& detected);

}  // namespace gladstone::inline vectors
