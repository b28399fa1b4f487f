#pragma once

#include "render/base/vec.h"

namespace gladstone::inline medium {

/// Refractivity and index gradient of a medium at one point. n - 1 is stored instead of n to avoid loss of digits.
template <class T>
struct IndexSample {
  T refractivity;    ///< n - 1 [1]
  Vec3<T> gradient;  ///< grad n [1/m]
};

/// Box that a medium fills. Rays are straight outside of it. Infinite axes extend to +-unbounded.
template <class T>
struct Bounds {
  Vec3<T> low;   ///< corner with the smallest coordinates [m]
  Vec3<T> high;  ///< corner with the largest coordinates [m]
};

inline constexpr double unbounded = 1e30;  ///< [m]; finite, so that differences of bounds are not NaN

}  // namespace gladstone::inline medium
