#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline sensor {

/// Sensor plane perpendicular to the optical axis.
template <class T>
struct Sensor {
  T z{};      ///< position of the plane on the axis [m]
  T pitch{};  ///< pixel pitch [m]
  int columns = 0;
  int rows = 0;

  /// Returns the pixel position of a point of the plane, as seen from the scene [m]. The lens inverts, the stored image
  /// does not: right in the scene is right in the image, up is up. The axis is at ((columns-1)/2, (rows-1)/2).
  GLADSTONE_HD Vec2<T> to_pixel(T x, T y) const {
    return {T(0.5) * T(columns - 1) - x / pitch, T(0.5) * T(rows - 1) + y / pitch};
  }
  /// Returns true if a pixel position is within the sensor's area.
  GLADSTONE_HD bool covers(Vec2<T> p) const {
    return p.x >= T(-0.5) && p.x < T(columns) - T(0.5) && p.y >= T(-0.5) && p.y < T(rows) - T(0.5);
  }
};

}  // namespace gladstone::inline sensor
