#pragma once

#include <optional>

namespace gladstone::tracking {

/// Contrast of the dots against their background.
enum class DotPolarity { automatic, bright, dark };

/// Shape of a dot image: a Gaussian of one width, or of any two widths and orientation.
enum class DotShape { round, elliptic };

/// Temporal noise of a camera. The variance of a pixel is read_noise^2 + levels_per_electron (level - black_level).
struct CameraNoise {
  double read_noise = 0;           ///< standard deviation, including rounding [grey levels]
  double levels_per_electron = 0;  ///< conversion gain [grey levels/e]; 0: no shot noise
  double black_level = 0;          ///< level without light [grey levels]
};

/// Settings of locate_dots().
struct DotSettings {
  DotPolarity polarity = DotPolarity::automatic;
  DotShape shape = DotShape::round;
  double diameter_px = 0;            ///< e^-2 diameter of a typical dot (four standard deviations) [px]; 0: estimated
  double detection_threshold = 5;    ///< smallest height of a dot after filtering, in standard deviations of noise [1]
  std::optional<CameraNoise> noise;  ///< none: uniform noise, estimated from the residual of the frame
};

}  // namespace gladstone::tracking
