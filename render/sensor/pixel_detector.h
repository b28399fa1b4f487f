#pragma once

#include <cmath>
#include <cstdint>

#include "render/base/random_variates.h"

namespace gladstone {

/// What one pixel makes of light.
struct PixelLevel {
  double level = 0;  ///< whole grey levels
  bool saturated = false;
};

/// What is a pixel's own, in every frame.
struct PixelPattern {
  double gain = 1;    ///< over the mean
  double offset = 0;  ///< of the black level [e]
  double hot = 0;     ///< charge that it collects in the dark [e]
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
  // light that is none of the sources', see BackgroundSetup
  int columns = 0, rows = 0;        ///< of the sensor; 0: no such light
  double background_e = 0;          ///< in the middle [e]
  double across_e = 0, down_e = 0;  ///< from the first column, row to the last [e]
  double const* glare_e = nullptr;  ///< of every pixel [e]; null: none
  // what differs from pixel to pixel, see NoiseSetup
  bool patterned = false;
  double prnu = 0, dsnu_e = 0, hot_pixel_share = 0, hot_pixel_e = 0;
  std::uint64_t pattern_seed = 0;

  /// Grey level of the sources' light alone, without noise, rounding and saturation.
  GLADSTONE_HD double ideal(double light) const { return offset + light * (electrons * levels_per_electron); }

  /// Electrons of the background; none are fewer than none.
  GLADSTONE_HD double background(std::uint64_t pixel) const {
    if (columns == 0) return 0;
    auto const width = static_cast<std::uint64_t>(columns);
    double const u = columns > 1 ? static_cast<double>(pixel % width) / (columns - 1) - 0.5 : 0;
    double const v = rows > 1 ? static_cast<double>(pixel / width) / (rows - 1) - 0.5 : 0;
    double const even = background_e + across_e * u + down_e * v;
    return (even > 0 ? even : 0) + (glare_e ? glare_e[pixel] : 0);
  }

  /// What is a pixel's own. Its four numbers are drawn always, so that one does not change with another.
  GLADSTONE_HD PixelPattern pattern(std::uint64_t pixel) const {
    using std::log;
    KeyedEngine engine(pattern_seed, RandomStream::sensor, pixel);
    PixelPattern own;
    own.gain = 1 + prnu * normal_variate(engine);
    own.gain = own.gain > 0 ? own.gain : 0;
    own.offset = dsnu_e * normal_variate(engine);
    bool const hot = to_unit(engine()) < hot_pixel_share;
    double const charge = -hot_pixel_e * log(1 - to_unit(engine()));
    own.hot = hot ? charge : 0;
    return own;
  }

  GLADSTONE_HD PixelLevel record(double light, RandomStream stream, std::uint64_t pixel) const {
    using std::floor;
    double charge = light * electrons + background(pixel);
    bool full = false;
    if (noisy) {
      KeyedEngine engine(seed, stream, pixel);
      PixelPattern const own = patterned ? pattern(pixel) : PixelPattern{};
      charge = charge * own.gain + dark_current_e + own.hot;
      // beyond 1e12 electrons any pixel is full
      if (shot_noise && charge > 0 && charge < 1e12) charge = poisson_variate(engine, charge);
      full = charge >= full_well_e;
      charge = (full ? full_well_e : charge) + own.offset;
      if (read_noise_e > 0) charge += read_noise_e * normal_variate(engine);
    }
    double const level = floor(offset + charge * levels_per_electron + 0.5);
    return {level < 0 ? 0 : (level > full_scale ? full_scale : level), full || level >= full_scale};
  }
};

}  // namespace gladstone
