#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "render/base/setup_table.h"
#include "render/sensor/posed_sensor.h"

namespace gladstone {

/// Table [camera.noise]; where it is absent the sensor is ideal.
struct NoiseSetup {
  bool enabled = false;
  double full_well_e = 30000;       ///< electrons at full scale; also the scale of an ideal sensor's exposure
  double read_noise_e = 3.0;        ///< standard deviation [e]
  double dark_current_e = 0.0;      ///< mean per frame [e]
  double quantum_efficiency = 0.6;  ///< electrons per photon
  bool shot_noise = true;
  std::uint64_t seed = 1;
  // what differs from pixel to pixel and is the same in all frames (EMVA Standard 1288, 2021, chapter 4)
  double prnu = 0;             ///< photo response non-uniformity: standard deviation of the gain over its mean [1]
  double dsnu_e = 0;           ///< dark signal non-uniformity: standard deviation of the black level [e]
  double hot_pixel_share = 0;  ///< of all pixels [1]
  double hot_pixel_e = 0;      ///< mean charge of a hot pixel a frame, exponentially distributed [e]
  std::uint64_t pattern_seed = 1;

  bool patterned() const { return prnu > 0 || dsnu_e > 0 || hot_pixel_share > 0; }
};

/// Table [camera.background]: light that is none of the sources', the same in all frames.
struct BackgroundSetup {
  double level_e = 0;      ///< electrons in the picture's middle
  Vec2d gradient_e{};      ///< by how much they grow from the first column to the last, and from the first row [e]
  std::string glare_file;  ///< a picture, stretched over the sensor; empty: none
  double glare_e = 0;      ///< electrons at its brightest

  /// Electrons that no pixel has more of.
  double most_e() const {
    return level_e + (std::abs(gradient_e.x) + std::abs(gradient_e.y)) / 2 + (glare_file.empty() ? 0 : glare_e);
  }
};

/// Table [camera] of a setup, in SI.
struct CameraSetup {
  int columns = 512;
  int rows = 512;
  double pixel_pitch = 10e-6;  ///< [m]
  int bit_depth = 16;
  /// Electrons in a pixel on the axis that is fully lit: that sees nothing but white paper through the whole stop,
  /// whatever its f-number. Empty: auto, which makes up for what a small stop costs the images of dots (wider spots,
  /// dimmer peaks); a number does not.
  std::optional<double> exposure_e;
  bool absolute_exposure = false;  ///< electrons follow from the light's photons, instead
  double offset_dn = 0;            ///< black level
  NoiseSetup noise;
  BackgroundSetup background;
  Vec2d tilt{};              ///< of the sensor about its x, then its turned y, through the axis point [rad]
  bool scheimpflug = false;  ///< tilted so that the plane in focus is sharp all over, instead of `tilt`
  BrownDistortion<double> distortion;

  bool tilted() const { return scheimpflug || tilt.x != 0 || tilt.y != 0; }
  bool distorted() const {
    return distortion.k1 != 0 || distortion.k2 != 0 || distortion.p1 != 0 || distortion.p2 != 0;
  }
};

CameraSetup read_camera_setup(SetupTable table);

/// By how much the mean of a pixel without light lies above its black level, since no level is below zero: the part of
/// read noise (and of dark electrons' shot noise, as a normal number) that is cut off there [grey levels].
double clipped_at_black(CameraSetup const& camera);

}  // namespace gladstone
