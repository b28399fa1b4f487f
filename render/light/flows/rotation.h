#pragma once

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Solid-body rotation about an axis parallel to Z, counterclockwise as seen by the camera: u = -rate (y - y0), v =
/// rate (x - x0).
struct RotationFlow {
  static constexpr char const* kind = "rotation";

  double rate = 0;  ///< angular velocity [rad/s]
  Vec3d center{};   ///< point (x0, y0) on the axis [m]

  static RotationFlow read(SetupTable& table) {
    RotationFlow flow;
    flow.rate = table.number("rate_rad_s", 1000.0, {-1e12, 1e12});
    flow.center = table.quantities("center_mm", flow.center, unit::millimetre, {-1e9, 1e9});
    return flow;
  }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    return {T(-rate) * (p.y - T(center.y)), T(rate) * (p.x - T(center.x)), T(0)};
  }
};

}  // namespace gladstone::inline light
