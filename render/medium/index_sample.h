#pragma once

#include "render/base/vec.h"

namespace gladstone {

/// What a medium says about one point. The refractivity n - 1 is kept instead of n, which would cost digits.
template <class T>
struct IndexSample {
  T refractivity;    ///< n - 1 [1]
  Vec3<T> gradient;  ///< grad n [1/m]
};

/// The region a medium fills; rays outside it go straight. Axes without end reach to +-unbounded.
template <class T>
struct Bounds {
  Vec3<T> low;   ///< [m]
  Vec3<T> high;  ///< [m]
};

inline constexpr double unbounded = 1e30;  ///< [m]; finite, so that no ray arithmetic meets inf - inf

}  // namespace gladstone
