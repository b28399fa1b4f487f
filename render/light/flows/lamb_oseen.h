#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/light/flows/vortex_keys.h"

namespace gladstone {

/// Lamb-Oseen vortex about an axis along Z: u_theta = Gamma / (2 pi r) (1 - exp(-r^2 / r_c^2)). Lamb, Hydrodynamics,
/// 1932, section 334a.
struct LambOseenFlow {
  static constexpr char const* kind = "lamb_oseen";

  VortexKeys keys;

  static LambOseenFlow read(SetupTable& table) { return {VortexKeys::read(table)}; }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    using std::expm1;
    T const x = p.x - T(keys.center.x), y = p.y - T(keys.center.y), r2 = x * x + y * y;
    T const core2 = T(keys.core_radius * keys.core_radius), over_2pi = T(keys.circulation / (2 * pi));
    // u_theta / r, which tends to Gamma / (2 pi r_c^2) in the middle
    T const rate = r2 > T(0) ? -over_2pi * expm1(-r2 / core2) / r2 : over_2pi / core2;
    return {-rate * y, rate * x, T(0)};
  }
};

}  // namespace gladstone
