#pragma once

#include <cmath>

#include "render/base/random.h"

/// Random variates from a KeyedEngine; host and device results differ at most by the rounding of log and cos.
namespace gladstone::inline base {

/// Returns a normal variate of mean 0 and standard deviation 1 (Box & Muller 1958).
GLADSTONE_HD inline double normal_variate(KeyedEngine& engine) {
  using std::cos;
  using std::log;
  using std::sqrt;
  constexpr double two_pi = 6.28318530717958647693;
  double const radius = sqrt(-2 * log(1 - to_unit(engine())));
  return radius * cos(two_pi * to_unit(engine()));
}

}  // namespace gladstone::inline base
