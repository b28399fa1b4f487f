#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// An ideal thin lens on the optical axis: exact in slopes, so stigmatic for every object plane and without aberration
/// (a collinear map). Rays run towards +z.
template <class T>
struct ThinLens {
  T z{};             ///< principal plane [m]
  T focal_length{};  ///< [m]

  /// Moves a ray to the lens and refracts it; the direction is unit length again.
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, T&) const {
    T const sx = ray.direction.x / ray.direction.z;
    T const sy = ray.direction.y / ray.direction.z;
    T const way = z - ray.position.z;
    T const x = ray.position.x + sx * way;
    T const y = ray.position.y + sy * way;
    ray.position = {x, y, z};
    ray.direction = normalized(Vec3<T>{sx - x / focal_length, sy - y / focal_length, T(1)});
    return RayStatus::alive;
  }
};

}  // namespace gladstone
