#pragma once

#include <cstdint>
#include <memory>

#include "render/base/image.h"
#include "render/base/random.h"
#include "render/sensor/camera_setup.h"
#include "render/sensor/pixel_detector.h"

namespace gladstone::inline sensor {

/// A recorded frame.
struct Recording {
  Image<std::uint16_t> image;  ///< grey levels, unshifted
  std::size_t saturated = 0;   ///< number of pixels at full well or full scale
};

/// Converts light to grey levels. The unit of light is the fully lit pixel on the axis, whose image is white paper.
class Detector {
 public:
  /// @param electrons_fully_lit  exposure: electrons per unit of light
  /// @throws DataError if the glare image cannot be used
  Detector(CameraSetup const& camera, double electrons_fully_lit);

  /// Returns the exposure [e] that puts the brightest noise-free pixel at 90 % of full scale, minus the largest
  /// background charge of any pixel.
  static double auto_exposure(CameraSetup const& camera, double brightest_light);

  /// Returns the grey level of light alone, offset + electrons * full scale / full well, without background, noise,
  /// rounding or saturation.
  double ideal_level(double light) const { return pixel_.ideal(light); }
  Image<double> ideal(Image<double> const& light) const;

  /// Records a frame: background, fixed pattern, hot pixels, shot noise (Poisson, of light and dark charge), read noise
  /// (normal), full well and rounding to the bit depth. Temporal noise is keyed by (seed, stream, pixel), in a
  /// sequence by (seed, number of the frame, pixel), the fixed pattern by (pattern seed, pixel). Without
  /// [camera.noise]: background, rounding and saturation only.
  Recording record(Image<double> const& light, RandomStream stream) const;

  /// Model of one pixel, for recording on another device.
  PixelDetector const& pixel() const { return pixel_; }

 private:
  PixelDetector pixel_;
  std::shared_ptr<Image<double> const> glare_;  ///< charge of the glare [e]
};

}  // namespace gladstone::inline sensor
