#pragma once

#include "render/base/host_device.h"
#include "render/base/lanes.h"

namespace gladstone::inline files {

/// Uniform cubic B-spline: four coefficients per cell and axis, C2, exact for cubic polynomials. Unser, Aldroubi &
/// Eden, IEEE Trans. Signal Process. 41 (1993) 821.
struct CubicBspline {
  static constexpr int support = 4;
  static constexpr int first = -1;  ///< first coefficient relative to the lower node of the cell

  /// Coefficient of u^power in the weight polynomial of coefficient `node` of a cell.
  GLADSTONE_HD static constexpr double power_in_weight(int power, int node) {
    constexpr double s = 1.0 / 6.0, t = 2.0 / 3.0, h = 0.5;
    constexpr double factor[4][4] = {{s, t, s, 0}, {-h, 0, h, 0}, {h, -1, h, 0}, {-s, h, -h, s}};
    return factor[power][node];
  }

  /// Computes the weights w and their derivatives d (per cell width) at position u in [0, 1] within the cell.
  template <class T>
  GLADSTONE_HD static void weigh(T u, Lanes<T, 4>& w, Lanes<T, 4>& d) {
    constexpr T s = T(1.0 / 6.0), t = T(2.0 / 3.0), h = T(0.5);
    constexpr T weight[4][4] = {{s, t, s, T(0)}, {-h, T(0), h, T(0)}, {h, T(-1), h, T(0)}, {-s, h, -h, s}};
    constexpr T slope[3][4] = {{-h, T(0), h, T(0)}, {T(1), T(-2), T(1), T(0)}, {-h, T(1.5), T(-1.5), h}};
    using Four = Lanes<T, 4>;
#if defined(__CUDA_ARCH__)
    // On a device, without SIMD lanes: the same polynomials with the fewest operations.
    T const v = T(1) - u, uu = u * u, vv = v * v;
    w.v[0] = s * v * vv;
    w.v[1] = t + uu * (h * u - T(1));
    w.v[3] = s * u * uu;
    w.v[2] = T(1) - w.v[0] - w.v[1] - w.v[3];
    d.v[0] = -h * vv;
    d.v[1] = u * (T(1.5) * u - T(2));
    d.v[3] = h * uu;
    d.v[2] = -d.v[0] - d.v[1] - d.v[3];
    return;
#endif
    Four const x = Four::all(u);
    Four const xx = x * x;
    w = (Four::load(weight[0]) + Four::load(weight[1]) * x) + (Four::load(weight[2]) + Four::load(weight[3]) * x) * xx;
    d = (Four::load(slope[0]) + Four::load(slope[1]) * x) + Four::load(slope[2]) * xx;
  }
  template <class T>
  GLADSTONE_HD static void weigh(T u, T (&w)[4], T (&d)[4]) {
    Lanes<T, 4> value, slope;
    weigh(u, value, slope);
    for (int i = 0; i < 4; ++i) {
      w[i] = value.v[i];
      d[i] = slope.v[i];
    }
  }
};

/// Piecewise linear interpolation: two nodes per cell and axis, continuous, with a discontinuous gradient.
struct Linear {
  static constexpr int support = 2;
  static constexpr int first = 0;

  GLADSTONE_HD static constexpr double power_in_weight(int power, int node) {
    return power == 0 ? (node == 0 ? 1.0 : 0.0) : (node == 0 ? -1.0 : 1.0);
  }

  template <class T>
  GLADSTONE_HD static void weigh(T u, Lanes<T, 2>& w, Lanes<T, 2>& d) {
    w = {{T(1) - u, u}};
    d = {{T(-1), T(1)}};
  }
};

}  // namespace gladstone::inline files
