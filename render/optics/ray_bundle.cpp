#include "render/optics/ray_bundle.h"

#include <cmath>

#include "render/base/units.h"

namespace gladstone::inline optics {

Vec2d sunflower(int k, int count) {
  double const golden_angle = pi * (3 - std::sqrt(5.0)), r = std::sqrt((k + 0.5) / count);
  return {r * std::cos(k * golden_angle), r * std::sin(k * golden_angle)};
}

}  // namespace gladstone::inline optics
