#pragma once

#include <cstdint>

#include "render/base/host_device.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline sensor {

/// Fixed-point value of a fully lit pixel. Images accumulate in 64-bit fixed point, so that sums depend neither on
/// order nor on the device. The range is 5e5 fully lit pixels, and the resolution 2^-44 of one.
inline constexpr double fixed_point_one = 0x1p44;

GLADSTONE_HD inline std::int64_t to_fixed_point(double share) {
  return static_cast<std::int64_t>(share * fixed_point_one + (share < 0 ? -0.5 : 0.5));
}

}  // namespace gladstone::inline sensor
