#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/units.h"
#include "render/base/vec.h"

namespace gladstone::inline scene {

/// Light through a lens from a small source, approximated by its intensity in the direction of the lens' centre.
struct LensLight {
  Vec3d centre{};         ///< centre of the entrance pupil [m]
  Vec3d axis{0, 0, 1};    ///< unit normal of the pupil
  double pupil_area = 1;  ///< area of the entrance pupil [m^2]; for chief rays, one square metre

  /// @param pupil  diameter of the entrance pupil [m]; 0: chief rays only
  static double area(double pupil) { return pupil > 0 ? pi / 4 * pupil * pupil : 1.0; }

  /// Returns the photons through the lens per incident photon fluence [m^2].
  /// @param cross_section  differential cross-section of the source towards the lens [m^2/sr]
  /// @param way            vector from the source to the lens' centre [m]
  /// @param far            length of `way` [m]
  GLADSTONE_HD double operator()(double cross_section, Vec3d way, double far) const {
    using std::abs;
    double const facing = abs(dot(axis, way)) / far;
    return cross_section * pupil_area * facing / (far * far);
  }
};

/// Differential cross-section of a particle that scatters the light incident on its geometric cross-section equally in
/// all directions [m^2/sr]. @param d  diameter [m]
GLADSTONE_HD constexpr double isotropic_cross_section(double d) { return d * d / 16; }

}  // namespace gladstone::inline scene
