#pragma once

#include <limits>

namespace gladstone {

/// The value of quantities that are not known.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace gladstone
