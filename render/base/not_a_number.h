#pragma once

#include <limits>

namespace gladstone::inline base {

/// Value of unknown quantities.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace gladstone::inline base
