#pragma once

#include <limits>

namespace gladstone {

/// Value of unknown quantities.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace gladstone
