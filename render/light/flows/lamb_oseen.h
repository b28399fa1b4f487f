#pragma once

#include <cmath>

#include "render/light/flows/plane_vortex.h"

namespace gladstone::inline light {

/// Lamb-Oseen vortex about an axis parallel to Z: u_theta = Gamma / (2 pi r) (1 - exp(-r^2 / r_c^2)). Lamb,
/// Hydrodynamics, 1932, section 334a.
struct LambOseenFlow {
  static constexpr char const* kind = "lamb_oseen";

  PlaneVortex vortex;

  static LambOseenFlow read(SetupTable& table) { return {PlaneVortex::read(table)}; }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    return vortex.velocity(p, [](T const& over_2pi, T const& r2, T const& core2) -> T {
      using std::expm1;
      // limit of u_theta / r on the axis: Gamma / (2 pi r_c^2)
      return r2 > T(0) ? T(-over_2pi * expm1(-r2 / core2) / r2) : T(over_2pi / core2);
    });
  }
};

}  // namespace gladstone::inline light
