#pragma once

#include <string>

#include "studies/compare/compare.h"

namespace gladstone {

/// Formats the error measures and the error budget as text tables.
std::string error_report(Comparison const& comparison);

}  // namespace gladstone
