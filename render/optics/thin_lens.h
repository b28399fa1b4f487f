#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// Ideal thin lens on the optical axis for rays in +z direction. Exact in slopes (a collinear map), and hence free of
/// aberrations for every object plane.
template <class T>
struct ThinLens {
  T z{};             ///< position of the principal plane on the axis [m]
  T focal_length{};  ///< [m]

  /// Moves a ray to the lens and deflects it.
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
