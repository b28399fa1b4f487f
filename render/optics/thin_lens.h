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
    if (stop_radius >= T(0) && x * x + y * y > stop_radius * stop_radius) return RayStatus::vignetted;
    ray.direction = normalized(Vec3<T>{sx - x / focal_length, sy - y / focal_length, T(1)});
    return RayStatus::alive;
  }
};

}  // namespace gladstone
