#pragma once

#include <cstdint>

#include "render/base/host_device.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone {

/// Images accumulate in 64-bit fixed point, so that sums depend neither on order nor on the device. The unit is 2^-44
/// of the light of a fully lit pixel: 5e5 times as much fits, and a ray's share is kept to 1e-10 of itself or better.
inline constexpr double fixed_point_one = 0x1p44;

GLADSTONE_HD inline std::int64_t to_fixed_point(double share) {
  return static_cast<std::int64_t>(share * fixed_point_one + (share < 0 ? -0.5 : 0.5));
}

}  // namespace gladstone
