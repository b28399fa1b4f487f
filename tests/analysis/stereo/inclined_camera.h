#pragma once

#include <cmath>
#include <numbers>

#include "analysis/calibration/pinhole_fit.h"

namespace gladstone::inline stereo {

inline constexpr double focal_px = 6500.0, distance_m = 0.65, scale = focal_px / distance_m;  // 10 px/mm on the axis

/// Returns a camera that looks at the origin from the distance distance_m; the direction to the camera is inclined from
/// the Z axis towards +X by an angle a. Its rotation is half a turn about (cos a/2, 0, -sin a/2).
inline PinholeCamera inclined_camera(double degrees) {
  double const half = 0.5 * degrees * std::numbers::pi / 180;
  return {{focal_px, focal_px, 256, 256, 0, 0, 0, 0, std::numbers::pi * std::cos(half), 0,
           -std::numbers::pi * std::sin(half), 0, 0, distance_m}};
}

}  // namespace gladstone::inline stereo
