#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Plane jet along a direction in the XY plane: u = peak / cosh^2(s / half width), s the distance from the symmetry
/// plane. Profile of Bickley, Phil. Mag. 23 (1937) 727, at one station; the jet does not spread.
struct JetFlow {
  static constexpr char const* kind = "jet";

  double peak = 0;        ///< velocity on the symmetry plane [m/s]
  double half_width = 1;  ///< [m]
  Vec2d along{1, 0};      ///< direction of the jet, unit length
  Vec3d center{};         ///< point on the symmetry plane [m]

  static JetFlow read(SetupTable& table) {
    JetFlow flow;
    flow.peak = table.number("peak_m_s", 10.0, {-1e9, 1e9});
    flow.half_width = table.number("half_width_mm", 5.0, Range::positive(1e9)) * unit::millimetre;
    flow.center = table.quantities("center_mm", flow.center, unit::millimetre, {-1e9, 1e9});
    auto const along = table.numbers("direction", {1, 0}, 2, {-1e9, 1e9});
    Vec2d const given = along.size() == 2 ? Vec2d{along[0], along[1]} : Vec2d{1, 0};
    if (length(given) > 0) {
      flow.along = given / length(given);
    } else {
      table.problem("direction", "is zero (a jet needs a direction); use [1, 0] for a jet along X");
    }
    return flow;
  }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    using std::cosh;
    T const s = T(along.x) * (p.y - T(center.y)) - T(along.y) * (p.x - T(center.x));
    T const c = cosh(s / T(half_width)), u = T(peak) / (c * c);
    return {T(along.x) * u, T(along.y) * u, T(0)};
  }
};

}  // namespace gladstone::inline light
