#pragma once

#include "render/base/host_device.h"

namespace gladstone {

/// Uniform cubic B-spline: four coefficients a cell, C2, exact for every cubic polynomial.
/// Unser, Aldroubi & Eden, IEEE Trans. Signal Process. 41 (1993) 821.
struct CubicBspline {
  static constexpr int support = 4;
  static constexpr int first = -1;  ///< first coefficient, counted from the cell's lower node

  /// Weights w and derivatives d (per cell width) at fraction u in [0, 1] of the cell.
  template <class T>
  GLADSTONE_HD static void weigh(T u, T (&w)[4], T (&d)[4]) {
    T const sixth = T(1.0 / 6.0);
    T const v = T(1) - u;
    T const uu = u * u;
    T const vv = v * v;
    w[0] = sixth * vv * v;
    w[3] = sixth * uu * u;
    w[1] = T(2.0 / 3.0) - uu + T(0.5) * uu * u;
    w[2] = T(2.0 / 3.0) - vv + T(0.5) * vv * v;
    d[0] = T(-0.5) * vv;
    d[3] = T(0.5) * uu;
    d[1] = u * (T(1.5) * u - T(2));
    d[2] = v * (T(2) - T(1.5) * v);
  }
};

/// Piecewise linear: two nodes a cell, continuous, with a gradient that jumps between cells.
struct Linear {
  static constexpr int support = 2;
  static constexpr int first = 0;

  template <class T>
  GLADSTONE_HD static void weigh(T u, T (&w)[2], T (&d)[2]) {
    w[0] = T(1) - u;
    w[1] = u;
    d[0] = T(-1);
    d[1] = T(1);
  }
};

}  // namespace gladstone
