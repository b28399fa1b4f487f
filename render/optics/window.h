#pragma once

#include <vector>

#include "render/base/pose.h"
#include "render/base/vec.h"
#include "render/setup/setup_table.h"

namespace gladstone {

/// Side of the medium on which a window is placed.
enum class WindowSide { target, camera };

/// Table [[window]]: plane-parallel plate of glass, in SI.
struct WindowSetup {
  WindowSide side = WindowSide::camera;
  std::string glass;
  double index = 1;       ///< index of the glass at the setup's wavelength, relative to its surroundings [1]
  double absorption = 0;  ///< absorption coefficient of the glass; 0 unless lens.transmittance includes it [1/m]
  double thickness = 0;   ///< [m]
  Vec3d position{};       ///< position of the plate's centre [m]
  Vec2d tilt{};           ///< right-handed rotations about x, then about the rotated y [rad]

  /// Pose of the plate's mid-plane in the world; light propagates along its z axis.
  Pose<double> pose() const { return Pose<double>{position}.turned({tilt.x, tilt.y, 0}); }
  /// Apparent displacement of objects towards the observer at normal incidence, t (1 - 1/n) [m].
  double shift() const { return thickness * (1 - 1 / index); }
};

/// Reads the tables, in the order of the light path. Indices are set later, when the wavelength is known.
std::vector<WindowSetup> read_windows(SetupTable root);

}  // namespace gladstone
