#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline optics {

/// Rectangular or elliptical aperture or obscuration of a surface, at any position. Circles about the axis are
/// represented by the surface's semi-diameter and obscured radius instead.
template <class T>
struct SurfaceOutline {
  enum class Kind : int { none, rectangle, ellipse };
  Kind kind = Kind::none;
  bool blocks = false;  ///< true: obscuration, light passes outside; false: aperture, light passes inside
  Vec2<T> half;         ///< half widths along x and y; infinite: unlimited [m]
  Vec2<T> centre;       ///< [m]

  /// Returns true if light passes at a point of the surface.
  GLADSTONE_HD bool passes(T const& x, T const& y) const {
    if (kind == Kind::none) return true;
    T const u = (x - centre.x) / half.x, v = (y - centre.y) / half.y;
    bool const inside = kind == Kind::ellipse ? u * u + v * v <= T(1) : u * u <= T(1) && v * v <= T(1);
    return inside != blocks;
  }

  template <class U>
  SurfaceOutline<U> in_scalar() const {
    return {static_cast<typename SurfaceOutline<U>::Kind>(kind),
            blocks,
            {U(half.x), U(half.y)},
            {U(centre.x), U(centre.y)}};
  }
};

}  // namespace gladstone::inline optics
