#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// The sensor's plane and its pixels; the one place where metres become pixels.
template <class T>
struct Sensor {
  T z{};      ///< plane [m]
  T pitch{};  ///< [m]
  int columns = 0;
  int rows = 0;

  /// Where a point of the plane, seen from the scene's side, lies in the picture [px]: the lens inverts, the picture
  /// does not (scene right is image right, scene up is image up). The axis hits ((columns-1)/2, (rows-1)/2).
  GLADSTONE_HD Vec2<T> to_pixel(T x, T y) const {
    return {T(0.5) * T(columns - 1) - x / pitch, T(0.5) * T(rows - 1) + y / pitch};
  }
  /// True where a pixel position lies on the sensor's area.
  GLADSTONE_HD bool covers(Vec2<T> p) const {
    return p.x >= T(-0.5) && p.x < T(columns) - T(0.5) && p.y >= T(-0.5) && p.y < T(rows) - T(0.5);
  }
};

}  // namespace gladstone
