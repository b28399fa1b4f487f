#pragma once

#include "render/base/lanes.h"

namespace gladstone::inline sensor {

/// Replaces each x by erf(x), for K rows of N numbers, without branches. Uses x P(2 x^2/25 - 1), where P of degree 26
/// interpolates at the Chebyshev points of |x| <= 5; beyond that range erf is one (erfc(5) = 1.5e-12). The error is
/// below 1e-12, and erf(-x) = -erf(x) to the last bit.
template <class T, int N, int K>
[[gnu::always_inline]] GLADSTONE_HD inline void error_function(Lanes<T, N> (&x)[K]) {
  constexpr double coefficients[27] = {
      0.2828425503200028,      -0.1414191726275182,    0.10605123860021683,   -0.08832127776977182,
      0.07711001336938555,     -0.06897127759001442,   0.062332484359944866,  -0.05628830930711225,
      0.050284013882049006,    -0.04404148524275623,   0.03752008934678752,   -0.030881946565228805,
      0.024499629295839986,    -0.0187516107326872,    0.013639019792235538,  -0.009234328716583386,
      0.0062371922316782555,   -0.004516570455570281,  0.002664513057675109,  -0.0008790892847756082,
      0.0005918950821114188,   -0.0009233752084005573, 0.000421091794823149,  0.00013397390931521363,
      -4.3633355781547676e-05, -9.511395652742862e-05, 3.948577052531454e-05,
  };
  using Row = Lanes<T, N>;
  // Evaluate even and odd powers, and all rows, as independent chains of multiplications.
  Row y[K], yy[K], even[K], odd[K];
  for (int i = 0; i < K; ++i) {
    x[i] = x[i].clamped(T(-5), T(5));
    y[i] = x[i] * x[i] * Row::all(T(2.0 / 25.0)) + Row::all(T(-1));
    yy[i] = y[i] * y[i];
    even[i] = Row::all(T(coefficients[26]));
    odd[i] = Row::all(T(coefficients[25]));
  }
  for (int k = 24; k > 0; k -= 2) {
    for (int i = 0; i < K; ++i) {
      even[i] = even[i] * yy[i] + Row::all(T(coefficients[k]));
      odd[i] = odd[i] * yy[i] + Row::all(T(coefficients[k - 1]));
    }
  }
  for (int i = 0; i < K; ++i) x[i] = x[i] * (odd[i] * y[i] + (even[i] * yy[i] + Row::all(T(coefficients[0]))));
}

}  // namespace gladstone::inline sensor
