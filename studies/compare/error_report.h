#pragma once

#include <string>

#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Formats the error measures and the error budget as text tables.
std::string error_report(Comparison const& comparison);

}  // namespace gladstone::inline compare
