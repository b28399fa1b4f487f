#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"
#include "render/base/vec.h"

namespace gladstone::inline base {

/// Position and orientation of an object in an outer frame, as the origin and axes of its right-handed local frame.
template <class T>
struct Pose {
  Vec3<T> origin{};             ///< origin of the local frame in the outer frame [m]
  Vec3<T> x{T(1), T(0), T(0)};  ///< unit vectors of the local axes in the outer frame
  Vec3<T> y{T(0), T(1), T(0)};
  Vec3<T> z{T(0), T(0), T(1)};

  /// Coordinate transforms from the outer to the local frame (to_local, inwards) and from the local to the outer one
  /// (to_outer, outwards).
  GLADSTONE_HD Vec3<T> direction_to_local(Vec3<T> d) const { return {dot(d, x), dot(d, y), dot(d, z)}; }
  GLADSTONE_HD Vec3<T> direction_to_outer(Vec3<T> d) const { return d.x * x + d.y * y + d.z * z; }
  GLADSTONE_HD Vec3<T> point_to_local(Vec3<T> p) const { return direction_to_local(p - origin); }
  GLADSTONE_HD Vec3<T> point_to_outer(Vec3<T> p) const { return origin + direction_to_outer(p); }
  GLADSTONE_HD Ray<T> inwards(Ray<T> const& ray) const {
    return {point_to_local(ray.position), direction_to_local(ray.direction)};
  }
  GLADSTONE_HD Ray<T> outwards(Ray<T> const& ray) const {
    return {point_to_outer(ray.position), direction_to_outer(ray.direction)};
  }
  /// Intersects the infinite line of a ray with the local plane z = 0.
  /// @param ray    ray in the outer frame
  /// @param place  receives the local coordinates (x, y) of the intersection [m]
  /// @return false if the ray is parallel to the plane
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = inwards(ray);
    if (local.direction.z == T(0)) return false;
    T const way = -local.position.z / local.direction.z;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }

  /// Returns this pose, given in the frame `outer`, as a pose in the frame in which `outer` is given.
  Pose within(Pose const& outer) const {
    return {outer.point_to_outer(origin), outer.direction_to_outer(x), outer.direction_to_outer(y),
            outer.direction_to_outer(z)};
  }
  /// Returns the pose translated by a vector in local coordinates [m].
  Pose moved(Vec3<T> by) const { return {point_to_outer(by), x, y, z}; }
  /// Returns the pose after right-handed rotations about its local x axis, the rotated y axis and then the rotated z
  /// axis.
  /// @param angles  rotation angles about x, y and z [rad]
  Pose turned(Vec3<T> angles) const;
};

/// Cross product.
template <class T>
GLADSTONE_HD constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
Pose<T> Pose<T>::turned(Vec3<T> angles) const {
  using std::cos;
  using std::sin;
  Pose pose = *this;
  // A rotation about one axis mixes the other two.
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

}  // namespace gladstone::inline base
