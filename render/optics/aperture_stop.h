#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// A circular stop on the optical axis.
template <class T>
struct ApertureStop {
  T z{};       ///< plane [m]
  T radius{};  ///< [m]
  T edge{};    ///< width of the zone about the edge that quadrature smooths, as a share of the stop's area; 0: sharp

  /// Share of a ray's light that counts at (x, y): one inside the stop, nothing outside, and across the edge zone the
  /// integral of the kernel (15/32)(3 - 10 t^2 + 7 t^4), whose moments 1 to 3 vanish (Gasser & Mueller 1979): integrals
  /// over the stop keep their value to O(edge^4), while rays no longer enter or leave them by jumps. Overshoots one and
  /// zero by 6 %.
  GLADSTONE_HD T transmission(T x, T y) const {
    T const inside = T(1) - (x * x + y * y) / (radius * radius);
    if (edge <= T(0)) return inside >= T(0) ? T(1) : T(0);
    T const t = T(2) * inside / edge;
    if (t <= T(-1)) return T(0);
    if (t >= T(1)) return T(1);
    T const tt = t * t;
    return T(0.5) + T(15.0 / 32.0) * t * (T(3) + tt * (T(-10.0 / 3.0) + T(1.4) * tt));
  }

  /// Moves a ray to the stop's plane and weighs it. @return vignetted outside the radius, whatever the edge zone leaves
  /// of it
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, T& weight) const {
    T const way = (z - ray.position.z) / ray.direction.z;
    ray.position = ray.position + ray.direction * way;
    T const x = ray.position.x, y = ray.position.y;
    weight *= transmission(x, y);
    return x * x + y * y > radius * radius ? RayStatus::vignetted : RayStatus::alive;
  }
};

}  // namespace gladstone
