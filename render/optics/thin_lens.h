#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// An ideal thin lens with its stop, on the optical axis: exact in slopes, so stigmatic for every object plane and without
/// aberration (a collinear map). Rays run towards +z.
template <class T>
struct ThinLens {
  T z{};             ///< principal plane [m]
  T focal_length{};  ///< [m]
  T stop_radius{};   ///< [m]; negative: no stop (chief-ray mode)
  T edge{};          ///< width of the zone about the stop's edge that quadrature smooths, as a share of its area

  /// Share of a ray's light that counts at (x, y) of the lens plane: one inside the stop, nothing outside, and across the
  /// edge zone the integral of the kernel (15/32)(3 - 10 t^2 + 7 t^4), whose moments 1 to 3 vanish (Gasser & Mueller 1979):
  /// integrals over the stop keep their value to O(edge^4) while rays no longer enter or leave by jumps.
  GLADSTONE_HD T transmission(T x, T y) const {
    if (stop_radius < T(0)) return T(1);
    T const inside = T(1) - (x * x + y * y) / (stop_radius * stop_radius);
    if (edge <= T(0)) return inside >= T(0) ? T(1) : T(0);
    T const t = T(2) * inside / edge;
    if (t <= T(-1)) return T(0);
    if (t >= T(1)) return T(1);
    T const tt = t * t;
    return T(0.5) + T(15.0 / 32.0) * t * (T(3) + tt * (T(-10.0 / 3.0) + T(1.4) * tt));
  }
  /// Refracts a ray and moves it to the lens plane. The direction is unit length again.
  /// @return alive, vignetted (outside the stop) or missed_lens (does not run towards it)
  GLADSTONE_HD RayStatus interact(Ray<T>& ray) const {
    if (!(ray.direction.z > T(0))) return RayStatus::missed_lens;
    T const sx = ray.direction.x / ray.direction.z;
    T const sy = ray.direction.y / ray.direction.z;
    T const way = z - ray.position.z;
    T const x = ray.position.x + sx * way;
    T const y = ray.position.y + sy * way;
    ray.position = {x, y, z};
    RayStatus const status = stop_radius >= T(0) && x * x + y * y > stop_radius * stop_radius ? RayStatus::vignetted : RayStatus::alive;
    ray.direction = normalized(Vec3<T>{sx - x / focal_length, sy - y / focal_length, T(1)});
    return status;
  }
};

}  // namespace gladstone
