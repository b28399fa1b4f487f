#pragma once

#include "render/light/flows/plane_vortex.h"

namespace gladstone::inline light {

/// Rankine vortex about an axis parallel to Z: u_theta = Gamma r / (2 pi r_c^2) for r < r_c, Gamma / (2 pi r) beyond.
struct RankineFlow {
  static constexpr char const* kind = "rankine";

  PlaneVortex vortex;

  static RankineFlow read(SetupTable& table) { return {PlaneVortex::read(table)}; }

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    return vortex.velocity(
        p, [](T const& over_2pi, T const& r2, T const& core2) -> T { return over_2pi / (r2 > core2 ? r2 : core2); });
  }
};

}  // namespace gladstone::inline light
