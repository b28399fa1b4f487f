#pragma once

#include <array>

namespace gladstone::inline density {

/// Returns the weights of the nodes -1, 0, 1, 2 in cubic interpolation at t in [0, 1] (Abramowitz & Stegun 25.2.13).
inline std::array<double, 4> lagrange_cubics(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

/// Returns the derivatives of the weights of lagrange_cubics() with respect to t.
inline std::array<double, 4> lagrange_cubic_slopes(double t) {
  return {-(3 * t * t - 6 * t + 2) / 6, (3 * t * t - 4 * t - 1) / 2, -(3 * t * t - 2 * t - 2) / 2, (3 * t * t - 1) / 6};
}

}  // namespace gladstone::inline density
