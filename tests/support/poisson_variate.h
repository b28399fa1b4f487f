#pragma once

#include <cmath>

#include "render/base/random.h"

namespace gladstone {

/// Computes ln k! for an integer k, as a product for k < 7, else by Stirling's series about k + 1; error below 1e-9.
inline double log_factorial(double k) {
  using std::log;
  if (k < 7) {
    double product = 1;
    for (double factor = 2; factor <= k; factor += 1) product *= factor;
    return log(product);
  }
  double const x = k + 1, inverse = 1 / x, square = inverse * inverse;
  constexpr double half_log_two_pi = 0.91893853320467274178;
  return (x - 0.5) * log(x) - x + half_log_two_pi +
         inverse * (1.0 / 12 - square * (1.0 / 360 - square * (1.0 / 1260 - square / 1680)));
}

/// Returns a Poisson variate: for means below 10 by multiplying uniform numbers (Knuth), else by transformed rejection
/// with a squeeze (Hoermann, Insurance: Mathematics and Economics 12 (1993) 39, algorithm PTRS).
/// @param mean  expected value, 0 to 1e12 [1]
inline double poisson_variate(KeyedEngine& engine, double mean) {
  using std::abs;
  using std::exp;
  using std::floor;
  using std::log;
  using std::sqrt;
  if (mean < 10) {
    double const limit = exp(-mean);
    double count = 0;
    for (double product = to_unit(engine()); product > limit; product *= to_unit(engine())) count += 1;
    return count;
  }
  double const log_mean = log(mean), b = 0.931 + 2.53 * sqrt(mean), a = -0.059 + 0.02483 * b;
  double const inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), squeeze = 0.9277 - 3.6224 / (b - 2);
  while (true) {
    double const u = to_unit(engine()) - 0.5, v = 1 - to_unit(engine()), edge = 0.5 - abs(u);
    double const k = floor((2 * a / edge + b) * u + mean + 0.43);
    if (edge >= 0.07 && v <= squeeze) return k;
    if (k < 0 || (edge < 0.013 && v > edge)) continue;
    double const accepted = log(v * inverse_alpha / (a / (edge * edge) + b));
    if (accepted <= k * log_mean - mean - log_factorial(k)) return k;
  }
}

}  // namespace gladstone
