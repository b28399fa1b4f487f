#pragma once

#include "render/base/read_vector.h"
#include "render/base/units.h"

namespace gladstone {

/// The keys that plane vortices about an axis along Z share.
struct VortexKeys {
  double circulation = 0;     ///< Gamma, counterclockwise as the camera sees it [m^2/s]
  double core_radius = 1e-3;  ///< r_c [m]
  Vec3d center{};             ///< [m]

  static VortexKeys read(SetupTable& table) {
    VortexKeys keys;
    keys.circulation = table.number("circulation_m2_s", 0.1, {-1e9, 1e9});
    keys.core_radius = table.number("core_radius_mm", 5.0, Range::positive(1e9)) * unit::millimetre;
    keys.center = read_vector(table, "center_mm", {}, unit::millimetre, {-1e9, 1e9});
    return keys;
  }
};

}  // namespace gladstone
