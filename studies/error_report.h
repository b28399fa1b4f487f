#pragma once

#include <string>

#include "studies/compare.h"

namespace gladstone {

/// The error measures and the budget as tables to read.
std::string error_report(Comparison const& comparison);

}  // namespace gladstone
