#pragma once

#include <cstdint>

#include "render/base/random_variates.h"

namespace gladstone {

/// What one pixel makes of light.
struct PixelLevel {
  double level = 0;  ///< whole grey levels
  bool saturated = false;
};

/// A camera's electronics, pixel by pixel, for every device.
struct PixelDetector {
  double electrons = 0;  ///< that light of 1 sets free
  double levels_per_electron = 0;
  double offset = 0;      ///< black level
  double full_scale = 0;  ///< highest grey level
  bool noisy = false;     ///< the rest counts only if so
  bool shot_noise = false;
  double full_well_e = 0;
  double dark_current_e = 0;
  double read_noise_e = 0;
  std::uint64_t seed = 0;

  /// Grey level without noise, rounding and saturation.
  GLADSTONE_HD double ideal(double light) const { return offset + light * (electrons * levels_per_electron); }

  GLADSTONE_HD PixelLevel record(double light, RandomStream stream, std::uint64_t pixel) const {
    using std::floor;
    double charge = light * electrons;
    bool full = false;
    if (noisy) {
      KeyedEngine engine(seed, stream, pixel);
      charge += dark_current_e;
      // beyond 1e12 electrons any pixel is full
      if (shot_noise && charge > 0 && charge < 1e12) charge = poisson_variate(engine, charge);
      full = charge >= full_well_e;
      charge = full ? full_well_e : charge;
      if (read_noise_e > 0) charge += read_noise_e * normal_variate(engine);
    }
    double const level = floor(offset + charge * levels_per_electron + 0.5);
    return {level < 0 ? 0 : (level > full_scale ? full_scale : level), full || level >= full_scale};
  }
};

}  // namespace gladstone
