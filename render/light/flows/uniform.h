#pragma once

#include "render/base/setup_table.h"

namespace gladstone {

/// Everything moves alike: by the flow's velocity_m_s alone.
struct UniformFlow {
  static constexpr char const* kind = "uniform";

  static UniformFlow read(SetupTable&) { return {}; }

  /// Velocity at p [m], beside the flow's own velocity_m_s [m/s].
  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const&) const {
    return {};
  }
};

}  // namespace gladstone
