#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// Intersects a ray with a surface z = sag(x, y) by Newton's method, from its conic, or from the vertex plane where the
/// ray misses the conic.
/// @param shape has `conic`, `sag(x, y)` and `gradient(p)` of z - sag(x, y)
/// @param way   along the ray to the surface, forwards or back [m]
/// @return false where the ray misses the surface
template <class T, class Shape>
GLADSTONE_HD bool intersect_asphere(Shape const& shape, Ray<T> const& ray, T& way) {
  constexpr int max_steps = 30;
  constexpr double tolerance = 1e-9;  // [m]; a ray meets the surface, or misses it by orders of magnitude
  if (!shape.conic.intersect(ray, way)) {
    if (ray.direction.z == T(0)) return false;
    way = -ray.position.z / ray.direction.z;
  }
  // steps shrink quadratically until rounding holds them up; one step after that makes derivatives exact as well
  T last = T(1);
  for (int step = 0; step < max_steps; ++step) {
    Vec3<T> const p = ray.position + way * ray.direction;
    T const height = p.z - shape.sag(p.x, p.y);
    Vec3<T> const up = shape.gradient(p);
    T const change = height / dot(up, ray.direction);
    T const size = change < T(0) ? -change : change;
    if (!(size < last)) return size < T(tolerance);  // NaN too ends here, off the conic's reach
    way = way - change;
    last = size;
    if (size == T(0)) return true;
  }
  return last < T(tolerance);
}

}  // namespace gladstone
