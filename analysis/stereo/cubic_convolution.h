#pragma once

#include <array>

namespace gladstone::inline stereo {

/// Returns the weights of the nodes at -1, 0, 1, 2 for a point at `t` between nodes 0 and 1, by cubic convolution
/// (Keys, IEEE Trans. ASSP 29 (1981) 1153, with a = -1/2), which reproduces quadratic polynomials.
inline std::array<double, 4> cubic_weights(double t) {
  return {t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2.0 - 1.5 * t)),
          t * t * (-0.5 + 0.5 * t)};
}

}  // namespace gladstone::inline stereo
