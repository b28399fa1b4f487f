#pragma once

#include <cmath>
#include <cstdint>

#include "render/base/random_variates.h"
#include "render/sensor/pixel_noise.h"

namespace gladstone::inline sensor {

/// Output of one pixel.
struct PixelLevel {
  double level = 0;  ///< grey level, a whole number
  bool saturated = false;
};

/// Fixed-pattern properties of one pixel, equal in all frames.
struct PixelPattern {
  double gain = 1;    ///< gain relative to the mean [1]
  double offset = 0;  ///< offset of the black level [e]
  double hot = 0;     ///< charge of a hot pixel [e]
};

/// Pixel-wise model of the camera's electronics, for host and device.
struct PixelDetector {
  double electrons = 0;            ///< electrons per unit of light [e]
  double levels_per_electron = 0;  ///< conversion gain [grey levels/e]
  double offset = 0;               ///< black level [grey levels]
  double full_scale = 0;           ///< highest grey level
  bool noisy = false;              ///< false: the noise parameters below are ignored
  bool shot_noise = false;
  double full_well_e = 0;
  double dark_current_e = 0;
  double read_noise_e = 0;
  std::uint64_t seed = 0;
  bool by_frame = false;        ///< frames of a sequence: both frames have the same random stream, but different seeds
  std::uint64_t flow_seed = 0;  ///< seed of frame B, if by_frame
  // stray light, see BackgroundSetup
  int columns = 0, rows = 0;        ///< size of the sensor [px]; 0: no stray light
  double background_e = 0;          ///< charge at the image centre [e]
  double across_e = 0, down_e = 0;  ///< increase of the background over all columns, rows [e]
  double const* glare_e = nullptr;  ///< charge of the glare in each pixel [e]; null: none
  // fixed pattern, see NoiseSetup
  bool patterned = false;
  double prnu = 0, dsnu_e = 0, hot_pixel_share = 0, hot_pixel_e = 0;
  std::uint64_t pattern_seed = 0;

  /// Returns the grey level of the light alone, without background, noise, rounding or saturation.
  GLADSTONE_HD double ideal(double light) const { return offset + light * (electrons * levels_per_electron); }

  /// Returns the charge of the background, at least zero [e].
  GLADSTONE_HD double background(std::uint64_t pixel) const {
    if (columns == 0) return 0;
    auto const width = static_cast<std::uint64_t>(columns);
    std::uint64_t const column = pixel % width, row = pixel / width;
    double const u = columns > 1 ? static_cast<double>(column) / (columns - 1) - 0.5 : 0;
    double const v = rows > 1 ? static_cast<double>(row) / (rows - 1) - 0.5 : 0;
    double const even = background_e + across_e * u + down_e * v;
    return (even > 0 ? even : 0) + (glare_e ? glare_e[pixel] : 0);
  }

  /// Draws the fixed pattern of a pixel. All random numbers are always drawn, so that each property is independent of
  /// whether the others are enabled.
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

  /// Returns the random numbers of the temporal noise of a frame.
  GLADSTONE_HD FrameNoise frame_noise(RandomStream stream) const {
    if (!by_frame) return {seed, stream};
    return {stream == RandomStream::noise_flow ? flow_seed : seed, RandomStream::noise_reference};
  }

  /// Returns the mean charge of a pixel with a given fixed pattern [e].
  GLADSTONE_HD double mean_charge(double light, std::uint64_t pixel, PixelPattern const& own) const {
    return with_dark_charge(light, background(pixel), own);
  }
  GLADSTONE_HD double with_dark_charge(double light, double stray_e, PixelPattern const& own) const {
    double const charge = light * electrons + stray_e;
    return noisy ? charge * own.gain + dark_current_e + own.hot : charge;
  }
  /// Reads out a charge [e]. @param read_noise  normal variate
  GLADSTONE_HD PixelLevel read_out(double charge, PixelPattern const& own, double read_noise) const {
    using std::floor;
    bool full = false;
    if (noisy) {
      full = charge >= full_well_e;
      charge = (full ? full_well_e : charge) + own.offset + read_noise_e * read_noise;
    }
    double const level = floor(offset + charge * levels_per_electron + 0.5);
    double const most = level > full_scale ? full_scale : level;
    return {most > 0 ? most : 0, full || level >= full_scale};
  }

  /// Records a pixel.
  GLADSTONE_HD PixelLevel record(double light, RandomStream stream, std::uint64_t pixel) const {
    PixelPattern const own = noisy && patterned ? pattern(pixel) : PixelPattern{};
    double charge = mean_charge(light, pixel, own);
    if (!noisy) return read_out(charge, own, 0);
    FrameNoise const noise = frame_noise(stream);
    if (shot_noise) charge = draw_electrons(charge, to_open_unit(noise.shot(pixel)));
    return read_out(charge, own, NormalQuantile{}(to_open_unit(noise.read(pixel))));
  }
};

}  // namespace gladstone::inline sensor
