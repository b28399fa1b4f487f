#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// A rectangle or an ellipse across a surface's axis, centred anywhere: an aperture, or an obscuration. Circles about
/// the axis are not outlines, but a surface's semi-diameter and its obscured radius.
template <class T>
struct SurfaceOutline {
  enum class Kind : int { none, rectangle, ellipse };
  Kind kind = Kind::none;
  bool blocks = false;  ///< light passes outside; false: inside
  Vec2<T> half;         ///< half widths along x and y; infinite: no limit [m]
  Vec2<T> centre;       ///< [m]

  /// Whether light passes at a place of the surface.
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

}  // namespace gladstone
