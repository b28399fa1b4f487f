#pragma once

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Plane shear: u = rate (y - y0).
struct ShearFlow {
  static constexpr char const* kind = "shear";

  double rate = 0;  ///< velocity gradient du/dy [1/s]
  Vec3d center{};   ///< point with zero velocity [m]

  static ShearFlow read(SetupTable& table) {
    ShearFlow flow;
    flow.rate = table.number("rate_1_s", 1000.0, {-1e12, 1e12});
    flow.center = table.quantities("center_mm", flow.center, unit::millimetre, {-1e9, 1e9});
    return flow;
  }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    return {T(rate) * (p.y - T(center.y)), T(0), T(0)};
  }
};

}  // namespace gladstone::inline light
