#pragma once

#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Uniform flow with the velocity `velocity_m_s` of table [flow].
struct UniformFlow {
  static constexpr char const* kind = "uniform";

  static UniformFlow read(SetupTable&) { return {}; }

  /// Returns zero: the uniform velocity is added by Flow [m/s].
  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const&) const {
    return {};
  }
};

}  // namespace gladstone::inline light
