#pragma once

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Plane stagnation flow: u = rate (x - x0), v = -rate (y - y0).
struct StagnationFlow {
  static constexpr char const* kind = "stagnation";

  double rate = 0;  ///< strain rate [1/s]
  Vec3d center{};   ///< stagnation point (x0, y0) [m]

  static StagnationFlow read(SetupTable& table) {
    StagnationFlow flow;
    flow.rate = table.number("rate_1_s", 1000.0, {-1e12, 1e12});
    flow.center = table.quantities("center_mm", flow.center, unit::millimetre, {-1e9, 1e9});
    return flow;
  }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    return {T(rate) * (p.x - T(center.x)), T(-rate) * (p.y - T(center.y)), T(0)};
  }
};

}  // namespace gladstone::inline light
