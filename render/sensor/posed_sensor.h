#pragma once

#include "render/base/host_device.h"
#include "render/base/in_scalar.h"
#include "render/base/pose.h"

namespace gladstone::inline sensor {

/// Brown's (1971) distortion in OpenCV's convention, on undistorted positions (x, y) / z_i, x right and y down:
/// x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y (1 + k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x
/// y.
template <class T>
struct BrownDistortion {
  T k1{}, k2{}, p1{}, p2{};

  /// Returns the shift of an undistorted position; exactly zero if all coefficients are zero [1].
  GLADSTONE_HD Vec2<T> shift(Vec2<T> at) const {
    T const x = at.x, y = at.y, r2 = x * x + y * y, radial = r2 * (k1 + k2 * r2);
    return {x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x),
            y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y};
  }
};

/// Sensor plane at any pose. Light travels along its +z axis. The only place where metres become pixels.
template <class T>
struct PosedSensor {
  Pose<T> pose;  ///< pose; its origin is at the centre of pixel ((columns-1)/2, (rows-1)/2)
  T pitch{};     ///< pixel pitch [m]
  int columns = 0;
  int rows = 0;
  BrownDistortion<T> distortion;
  T distance = T(1);  ///< image distance z_i, by which positions are divided for the distortion [m]

  GLADSTONE_HD Vec2<T> axis_pixel() const { return {T(0.5) * T(columns - 1), T(0.5) * T(rows - 1)}; }

  /// Returns the pixel position of a point of the plane in the sensor's frame [m]. The lens inverts, the stored image
  /// does not: right in the scene is right in the image, up is up.
  GLADSTONE_HD Vec2<T> to_pixel(T x, T y) const {
    Vec2<T> const moved = distance * distortion.shift({-x / distance, y / distance});
    return axis_pixel() + Vec2<T>{(moved.x - x) / pitch, (moved.y + y) / pitch};
  }
  /// Like to_pixel(), without distortion.
  GLADSTONE_HD Vec2<T> undistorted_pixel(T x, T y) const { return axis_pixel() + Vec2<T>{-x / pitch, y / pitch}; }

  /// Intersects a ray with the plane. @param place  intersection in the sensor's frame [m]
  /// @return false if the ray does not travel towards the plane
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = pose.inwards(ray);
    if (!(local.direction.z > T(0))) return false;
    T const way = -local.position.z / local.direction.z;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }
  /// Returns true if a pixel position is within the sensor's area.
  GLADSTONE_HD bool covers(Vec2<T> p) const {
    return p.x >= T(-0.5) && p.x < T(columns) - T(0.5) && p.y >= T(-0.5) && p.y < T(rows) - T(0.5);
  }

  /// Converts the sensor to another scalar type.
  template <class U>
  PosedSensor<U> in_scalar() const {
    BrownDistortion<U> const same{U(distortion.k1), U(distortion.k2), U(distortion.p1), U(distortion.p2)};
    return {gladstone::in_scalar<U>(pose), U(pitch), columns, rows, same, U(distance)};
  }
};

}  // namespace gladstone::inline sensor
