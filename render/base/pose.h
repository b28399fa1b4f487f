#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"
#include "render/base/vec.h"

namespace gladstone {

/// Where something stands in an outer frame, and how it is turned there: its origin and its own right-handed axes.
template <class T>
struct Pose {
  Vec3<T> origin{};             ///< in the outer frame [m]
  Vec3<T> x{T(1), T(0), T(0)};  ///< own axes in the outer frame, unit length
  Vec3<T> y{T(0), T(1), T(0)};
  Vec3<T> z{T(0), T(0), T(1)};

  GLADSTONE_HD Vec3<T> direction_inwards(Vec3<T> d) const { return {dot(d, x), dot(d, y), dot(d, z)}; }
  GLADSTONE_HD Vec3<T> direction_outwards(Vec3<T> d) const { return d.x * x + d.y * y + d.z * z; }
  GLADSTONE_HD Vec3<T> point_inwards(Vec3<T> p) const { return direction_inwards(p - origin); }
  GLADSTONE_HD Vec3<T> point_outwards(Vec3<T> p) const { return origin + direction_outwards(p); }
  GLADSTONE_HD Ray<T> inwards(Ray<T> const& ray) const {
    return {point_inwards(ray.position), direction_inwards(ray.direction)};
  }
  GLADSTONE_HD Ray<T> outwards(Ray<T> const& ray) const {
    return {point_outwards(ray.position), direction_outwards(ray.direction)};
  }
  /// Where a ray, or what goes on from it either way, meets the plane of x and y, in the pose's own frame. @return
  /// false where it runs along the plane
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = inwards(ray);
    if (local.direction.z == T(0)) return false;
    T const way = -local.position.z / local.direction.z;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }

  /// The same place in the frame that `outer` is given in, where this one is given in outer's.
  Pose within(Pose const& outer) const {
    return {outer.point_outwards(origin), outer.direction_outwards(x), outer.direction_outwards(y),
            outer.direction_outwards(z)};
  }
  /// Moved by a vector given in its own axes.
  Pose moved(Vec3<T> by) const { return {point_outwards(by), x, y, z}; }
  /// Turned about its own axes, right-handed: about x, then about the turned y, then about the turned z.
  /// @param angles [rad]
  Pose turned(Vec3<T> angles) const;
};

/// Vector product.
template <class T>
GLADSTONE_HD constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
Pose<T> Pose<T>::turned(Vec3<T> angles) const {
  using std::cos;
  using std::sin;
  Pose pose = *this;
  // turning about an axis mixes the other two
  auto const turn = [](Vec3<T>& a, Vec3<T>& b, T const& angle) {
    Vec3<T> const first = cos(angle) * a + sin(angle) * b;
    b = cos(angle) * b - sin(angle) * a;
    a = first;
  };
  turn(pose.y, pose.z, angles.x);
  turn(pose.z, pose.x, angles.y);
  turn(pose.x, pose.y, angles.z);
  return pose;
}

}  // namespace gladstone
