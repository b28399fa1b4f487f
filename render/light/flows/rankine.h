#pragma once

#include "render/base/units.h"
#include "render/light/flows/vortex_keys.h"

namespace gladstone {

/// Rankine vortex about an axis along Z: u_theta = Gamma r / (2 pi r_c^2) inside r_c, Gamma / (2 pi r) beyond.
struct RankineFlow {
  static constexpr char const* kind = "rankine";

  VortexKeys keys;

  static RankineFlow read(SetupTable& table) { return {VortexKeys::read(table)}; }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    T const x = p.x - T(keys.center.x), y = p.y - T(keys.center.y), r2 = x * x + y * y;
    T const core2 = T(keys.core_radius * keys.core_radius);
    T const rate = T(keys.circulation / (2 * pi)) / (r2 > core2 ? r2 : core2);
    return {-rate * y, rate * x, T(0)};
  }
};

}  // namespace gladstone
