#pragma once

namespace gladstone::inline tracking {

/// Contrast of the dots against their background.
enum class DotPolarity { automatic, bright, dark };

/// Shape of a dot image: round (a Gaussian with one width) or elliptic (a Gaussian with two widths and any
/// orientation).
enum class DotShape { round, elliptic };

/// Settings of locate_dots().
struct DotSettings {
  DotPolarity polarity = DotPolarity::automatic;
  DotShape shape = DotShape::round;
  double diameter_px = 0;          ///< e^-2 diameter of a typical dot (four standard deviations) [px]; 0: estimated
  double detection_threshold = 5;  ///< minimum height of a dot after filtering, in standard deviations of the noise [1]
};

}  // namespace gladstone::inline tracking
