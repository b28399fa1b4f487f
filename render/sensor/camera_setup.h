#pragma once

#include <cstdint>
#include <optional>

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
  double offset_dn = 0;  ///< black level
  NoiseSetup noise;
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
