#pragma once

#include "render/base/host_device.h"

namespace gladstone::inline optics {

/// Circular aperture stop about the origin of its plane.
template <class T>
struct ApertureStop {
  T radius{};  ///< [m]
  T edge{};    ///< area of the smoothed zone about the edge, relative to the stop's area [1]; 0: sharp edge

  /// Returns the transmission at (x, y): one inside the stop, zero outside. Across the edge zone it is the integral of
  /// the kernel (15/32)(3 - 10 t^2 + 7 t^4), whose moments 1 to 3 vanish (Gasser & Mueller 1979). Integrals over the
  /// stop are then smooth functions of the ray positions, with an error of O(edge^4). The transmission overshoots one
  /// and zero by 6 %.
  GLADSTONE_HD T transmission(T x, T y) const {
    T const inside = T(1) - (x * x + y * y) / (radius * radius);
    if (edge <= T(0)) return inside >= T(0) ? T(1) : T(0);
    T const t = T(2) * inside / edge;
    if (t <= T(-1)) return T(0);
    if (t >= T(1)) return T(1);
    T const tt = t * t;
    return T(0.5) + T(15.0 / 32.0) * t * (T(3) + tt * (T(-10.0 / 3.0) + T(1.4) * tt));
  }
};

}  // namespace gladstone::inline optics
