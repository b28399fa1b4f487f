#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone::inline optics {

/// Intersects a ray with a surface z = sag(x, y) by Newton's method, starting at the intersection with the surface's
/// conic or, if the ray misses the conic, with the vertex plane.
/// @param shape  has `conic`, `sag(x, y)` and `gradient(p)` of z - sag(x, y)
/// @param way    distance along the ray to the surface, negative backwards [m]
/// @return false if the ray misses the surface
template <class T, class Shape>
GLADSTONE_HD bool intersect_asphere(Shape const& shape, Ray<T> const& ray, T& way) {
  constexpr int max_steps = 30;
  constexpr double tolerance = 1e-9;  // tolerance [m]; the residual is far smaller on a hit and far larger on a miss
  if (!shape.conic.intersect(ray, way)) {
    if (ray.direction.z == T(0)) return false;
    way = -ray.position.z / ray.direction.z;
  }
  // The steps decrease quadratically down to rounding errors; one more step makes the derivatives exact (ceres::Jet).
  T last = T(1);
  for (int step = 0; step < max_steps; ++step) {
    Vec3<T> const p = ray.position + way * ray.direction;
    T const height = p.z - shape.sag(p.x, p.y);
    Vec3<T> const up = shape.gradient(p);
    T const change = height / dot(up, ray.direction);
    T const size = change < T(0) ? -change : change;
    if (!(size < last)) return size < T(tolerance);  // detects also NaN, beyond the extent of the conic
    way = way - change;
    last = size;
    if (size == T(0)) return true;
  }
  return last < T(tolerance);
}

}  // namespace gladstone::inline optics
