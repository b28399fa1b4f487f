#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone::inline optics {

/// Plane through the vertex, tilted relative to the coordinate frame: z = slope.x x + slope.y y.
template <class T>
struct TiltedPlane {
  Vec2<T> slope;  ///< tangents of the tilt [1]

  GLADSTONE_HD T sag(T const& x, T const& y) const { return slope.x * x + slope.y * y; }

  /// @param way  distance along the ray to the plane, negative backwards [m]
  /// @return false if the ray is parallel to the plane
  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const {
    Vec3<T> const& d = ray.direction;
    T const closing = d.z - sag(d.x, d.y);
    if (closing == T(0)) return false;
    way = (sag(ray.position.x, ray.position.y) - ray.position.z) / closing;
    return true;
  }

  GLADSTONE_HD Vec3<T> normal(Vec3<T> const&) const { return normalized(Vec3<T>{-slope.x, -slope.y, T(1)}); }

  GLADSTONE_HD T vertex_curvature() const { return T(0); }

  template <class U>
  TiltedPlane<U> in_scalar() const {
    return {{U(slope.x), U(slope.y)}};
  }
};

}  // namespace gladstone::inline optics
