#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "render/sensor/posed_sensor.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline sensor {

/// Table [camera.noise]. Without it the sensor is ideal.
struct NoiseSetup {
  bool enabled = false;
  double full_well_e = 30000;       ///< electrons at full scale, also for an ideal sensor [e]
  double read_noise_e = 3.0;        ///< standard deviation of the read noise [e]
  double dark_current_e = 0.0;      ///< mean dark charge per frame [e]
  double quantum_efficiency = 0.6;  ///< electrons per photon [1]
  bool shot_noise = true;
  std::uint64_t seed = 1;
  /// Numbers of both frames in a sequence, which key their noise in addition to `seed`; empty: a single pair.
  std::optional<std::array<std::uint64_t, 2>> frames;
  // fixed pattern: differs between pixels, equal in all frames (EMVA Standard 1288, 2021, chapter 4)
  double prnu = 0;             ///< photo response non-uniformity: relative standard deviation of the gain [1]
  double dsnu_e = 0;           ///< dark signal non-uniformity: standard deviation of the black level [e]
  double hot_pixel_share = 0;  ///< fraction of hot pixels [1]
  double hot_pixel_e = 0;      ///< mean charge of a hot pixel per frame, exponentially distributed [e]
  std::uint64_t pattern_seed = 1;

  bool patterned() const { return prnu > 0 || dsnu_e > 0 || hot_pixel_share > 0; }
};

/// Table [camera.background]: stray light, equal in all frames.
struct BackgroundSetup {
  double level_e = 0;      ///< charge at the image centre [e]
  Vec2d gradient_e{};      ///< increase from the first to the last column, and row [e]
  std::string glare_file;  ///< image of the glare, scaled to the size of the sensor; empty: none
  double glare_e = 0;      ///< charge at the brightest point of the glare [e]

  /// Upper bound of the background charge in any pixel [e].
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
  /// Electrons in a fully lit pixel on the axis, that is, one whose image is uniform white paper, at any f-number.
  /// Empty: "auto", chosen from the brightest pixel of the frames, which compensates the dimmer, wider dot images of a
  /// small aperture; a number does not.
  std::optional<double> exposure_e;
  bool absolute_exposure = false;  ///< "absolute": electrons follow from the photons of [light] or [laser]
  double offset_dn = 0;            ///< black level [grey levels]
  NoiseSetup noise;
  BackgroundSetup background;
  Vec2d tilt{};              ///< rotation about the sensor's x, then its rotated y axis, through the axis point [rad]
  bool scheimpflug = false;  ///< tilt from the Scheimpflug condition instead of `tilt`
  BrownDistortion<double> distortion;

  bool tilted() const { return scheimpflug || tilt.x != 0 || tilt.y != 0; }
  bool distorted() const {
    return distortion.k1 != 0 || distortion.k2 != 0 || distortion.p1 != 0 || distortion.p2 != 0;
  }
};

CameraSetup read_camera_setup(SetupTable table);

/// Returns the bias of the mean grey level of an unlit pixel that results from clipping at zero [grey levels].
/// Read noise and the shot noise of the dark charge are taken as normally distributed.
double clipped_at_black(CameraSetup const& camera);

}  // namespace gladstone::inline sensor
