#pragma once

#include <vector>

#include "analysis/tracking/gaussian_dot.h"
#include "render/base/image.h"

namespace gladstone::inline tracking {

/// Frame prepared for the detection of dots: levels above the background, with bright dots.
struct DotFrame {
  Image<double> above;  ///< contrast of the dots: frame minus background, inverted for dark dots; NaN: ignored pixel
  bool bright = true;
  double noise = 0;  ///< standard deviation of the noise [grey levels]
};

/// Subtracts the background (estimate_background()) and determines the polarity of the dots, which is the sign of the
/// largest deviation from the background after smoothing. The noise is estimated from the pixels below the background,
/// which receive no light from dots.
DotFrame prepare_dot_frame(Image<double> const& frame, DotSettings const& settings);

/// Estimates the noise of a frame from its residual after subtraction of all fitted dots: 1.4826 times the median
/// absolute deviation, at least the rounding noise (0.29 grey levels) if all grey levels of the frame are integers.
double estimate_noise(Image<double> const& residual, bool whole_levels);

/// Estimates the standard deviation of typical dot images [px] from the autocorrelation R of the frame at shifts of one
/// and two pixels along the axes, which uncorrelated noise does not affect: R(s) ~ exp(-s^2 / (4 sigma^2)). The error
/// is below 30 % for sigma from 0.3 to 10 px if dots do not overlap much. Returns 0.75 px if the frame does not
/// determine sigma.
double estimate_dot_sigma(Image<double> const& above);

/// Finds the local maxima of the frame after a Gaussian filter that is nearly matched to the dots.
/// @param sigma_px  standard deviation of a typical dot [px]
/// @return dots with estimated centres and fluxes, row by row; two dots that are closer than about two standard
///         deviations of their images yield one common maximum
std::vector<GaussianDot> find_dot_candidates(DotFrame const& frame, double sigma_px, double detection_threshold);

}  // namespace gladstone::inline tracking
