#pragma once

#include <vector>

#include "render/base/pose.h"
#include "render/base/setup_table.h"
#include "render/base/vec.h"

namespace gladstone {

/// On which side of the medium a window stands.
enum class WindowSide { target, camera };

/// One table [[window]]: a plane-parallel plate of glass, in SI.
struct WindowSetup {
  WindowSide side = WindowSide::camera;
  std::string glass;
  std::string where;      ///< file:line of the glass, for messages
  double index = 1;       ///< of the glass at the setup's wavelength, against its surroundings [1]
  double absorption = 0;  ///< of the glass, in light per length; 0 unless asked for [1/m]
  double thickness = 0;   ///< [m]
  Vec3d position{};       ///< of its centre [m]
  Vec2d tilt{};           ///< right-handed about x, then about the turned y [rad]

  /// Of its middle, in the world; light goes along its z.
  Pose<double> pose() const { return Pose<double>{position}.turned({tilt.x, tilt.y, 0}); }
  /// By how much it brings nearer what is seen through it squarely, t (1 - 1/n) [m].
  double shift() const { return thickness * (1 - 1 / index); }
};

/// Reads the tables in the order light meets them. Indices are found later, with the wavelength.
std::vector<WindowSetup> read_windows(SetupTable root);

}  // namespace gladstone
