#pragma once

#include <cstdint>
#include <memory>

#include "render/base/image.h"
#include "render/base/random.h"
#include "render/sensor/camera_setup.h"
#include "render/sensor/pixel_detector.h"

namespace gladstone {

/// A recorded frame.
struct Recording {
  Image<std::uint16_t> image;  ///< grey levels, unshifted
  std::size_t saturated = 0;   ///< pixels at full well or full scale
};

/// Turns light into grey levels. Light is measured in fully lit pixels on the axis (1 = a pixel that sees white paper).
class Detector {
 public:
  /// @param electrons_fully_lit exposure: electrons that light of 1 sets free
  /// @throws DataError of a glare's picture
  Detector(CameraSetup const& camera, double electrons_fully_lit);

  /// The exposure that puts the brightest noise-free pixel at 90 % of full scale, or below it by what the background
  /// has less there than at its brightest [e].
  static double auto_exposure(CameraSetup const& camera, double brightest_light);

  /// Grey level without background, noise, rounding and saturation: offset + electrons * full scale / full well.
  double ideal_level(double light) const { return pixel_.ideal(light); }
  Image<double> ideal(Image<double> const& light) const;

  /// Records a frame: background, fixed pattern and hot pixels, shot noise (Poisson in light and dark electrons), read
  /// noise (normal), full well, rounding to the bit depth. Noise is keyed by (seed, stream, pixel), what is fixed by
  /// (pattern seed, pixel). Without [camera.noise]: background, rounding and saturation only.
  Recording record(Image<double> const& light, RandomStream stream) const;

  /// What it does to a pixel, for those who do it elsewhere.
  PixelDetector const& pixel() const { return pixel_; }
  /// Grey levels that one unit of light is worth.
  double levels_per_light() const { return pixel_.electrons * pixel_.levels_per_electron; }
  double full_scale() const { return pixel_.full_scale; }

 private:
  PixelDetector pixel_;
  std::shared_ptr<Image<double> const> glare_;  ///< [e]
};

}  // namespace gladstone
