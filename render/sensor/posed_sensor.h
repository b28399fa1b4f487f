#pragma once

#include "render/base/host_device.h"
#include "render/base/in_scalar.h"
#include "render/base/pose.h"

namespace gladstone {

/// Distortion after Brown (1971) as OpenCV writes it, of undistorted places (x, y) / z_i, x right and y down:
/// x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y (1 + k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x
/// y.
template <class T>
struct BrownDistortion {
  T k1{}, k2{}, p1{}, p2{};

  /// By how much it moves a place; exactly nothing without coefficients.
  GLADSTONE_HD Vec2<T> shift(Vec2<T> at) const {
    T const x = at.x, y = at.y, r2 = x * x + y * y, radial = r2 * (k1 + k2 * r2);
    return {x * radial + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x),
            y * radial + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y};
  }
};

/// The sensor's plane anywhere, tilted as may be; the one place where metres become pixels. Light runs along its z.
template <class T>
struct PosedSensor {
  Pose<T> pose;  ///< its origin is the axis point, which pixel ((columns-1)/2, (rows-1)/2) has its centre at
  T pitch{};     ///< [m]
  int columns = 0;
  int rows = 0;
  BrownDistortion<T> distortion;
  T distance = T(1);  ///< z_i, that distorted places are measured in [m]

  GLADSTONE_HD Vec2<T> axis_pixel() const { return {T(0.5) * T(columns - 1), T(0.5) * T(rows - 1)}; }

  /// Where a point of the plane, in its own frame, lies in the picture [px]: the lens inverts, the picture does not
  /// (scene right is image right, scene up is image up).
  GLADSTONE_HD Vec2<T> to_pixel(T x, T y) const {
    Vec2<T> const moved = distance * distortion.shift({-x / distance, y / distance});
    return axis_pixel() + Vec2<T>{(moved.x - x) / pitch, (moved.y + y) / pitch};
  }
  /// The same without distortion.
  GLADSTONE_HD Vec2<T> undistorted_pixel(T x, T y) const { return axis_pixel() + Vec2<T>{-x / pitch, y / pitch}; }

  /// Where a ray meets the plane, in its own frame [m]. @return false for rays that do not run towards it
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = pose.inwards(ray);
    if (!(local.direction.z > T(0))) return false;
    T const way = -local.position.z / local.direction.z;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }
  /// True where a pixel position lies on the sensor's area.
  GLADSTONE_HD bool covers(Vec2<T> p) const {
    return p.x >= T(-0.5) && p.x < T(columns) - T(0.5) && p.y >= T(-0.5) && p.y < T(rows) - T(0.5);
  }

  /// The same sensor in another scalar.
  template <class U>
  PosedSensor<U> in_scalar() const {
    BrownDistortion<U> const same{U(distortion.k1), U(distortion.k2), U(distortion.p1), U(distortion.p2)};
    return {gladstone::in_scalar<U>(pose), U(pitch), columns, rows, same, U(distance)};
  }
};

}  // namespace gladstone
