#pragma once

#include "render/base/pose.h"

namespace gladstone {

/// The same thing in another scalar U: in ceres::Jets, what is computed from it carries its derivatives. For hosts.
template <class U, class T>
Vec3<U> in_scalar(Vec3<T> const& a) {
  return {U(a.x), U(a.y), U(a.z)};
}
template <class U, class T>
Ray<U> in_scalar(Ray<T> const& ray) {
  return {in_scalar<U>(ray.position), in_scalar<U>(ray.direction)};
}
template <class U, class T>
Pose<U> in_scalar(Pose<T> const& pose) {
  return {in_scalar<U>(pose.origin), in_scalar<U>(pose.x), in_scalar<U>(pose.y), in_scalar<U>(pose.z)};
}

}  // namespace gladstone
