#pragma once

#include "render/base/pose.h"

namespace gladstone::inline base {

/// Converts a vector or pose to another scalar type U. With U = ceres::Jet, results computed from it carry their
/// derivatives. Host code only.
template <class U, class T>
Vec3<U> in_scalar(Vec3<T> const& a) {
  return {U(a.x), U(a.y), U(a.z)};
}
template <class U, class T>
Pose<U> in_scalar(Pose<T> const& pose) {
  return {in_scalar<U>(pose.origin), in_scalar<U>(pose.x), in_scalar<U>(pose.y), in_scalar<U>(pose.z)};
}

}  // namespace gladstone::inline base
