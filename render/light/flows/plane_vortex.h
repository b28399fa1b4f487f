#pragma once

#include "render/base/units.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Parameters and velocity of a vortex about an axis parallel to Z, common to all vortex models.
struct PlaneVortex {
  double circulation = 0.1;   ///< Gamma, counterclockwise as seen by the camera [m^2/s]
  double core_radius = 5e-3;  ///< r_c [m]
  Vec3d center{};             ///< point on the axis [m]

  static PlaneVortex read(SetupTable& table) {
    PlaneVortex keys;
    keys.circulation = table.number("circulation_m2_s", keys.circulation, {-1e9, 1e9});
    keys.core_radius = table.quantity("core_radius_mm", keys.core_radius, unit::millimetre, Range::positive(1e9));
    keys.center = table.quantities("center_mm", keys.center, unit::millimetre, {-1e9, 1e9});
    return keys;
  }

  /// Returns the velocity [m/s] at a point p [m].
  /// @param rate  angular velocity u_theta / r [1/s] as a function of Gamma / (2 pi) [m^2/s], r^2 and r_c^2 [m^2]
  template <class T, class Rate>
  GLADSTONE_HD Vec3<T> velocity(Vec3<T> const& p, Rate const& rate) const {
    T const x = p.x - T(center.x), y = p.y - T(center.y);
    T const turning = rate(T(circulation / (2 * pi)), x * x + y * y, T(core_radius * core_radius));
    return {-turning * y, turning * x, T(0)};
  }
};

}  // namespace gladstone::inline light
