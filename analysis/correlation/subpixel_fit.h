#pragma once

#include <string>
#include <vector>

namespace gladstone::inline correlation {

/// Samples around the highest sample of a peak; the decrease of the plane caused by the weights is divided out.
struct PeakPatch {
  double value[3][3];  ///< row dy + 1, column dx + 1; the middle is positive and the highest
};

/// Peak position and height between the samples.
struct PeakFit {
  double x = 0.0;         ///< distance to the right of the middle sample, within [-1, 1] [px]
  double y = 0.0;         ///< distance below the middle sample, within [-1, 1] [px]
  double log_rise = 0.0;  ///< logarithm of the peak height over the middle sample [1]
};

using SubpixelFit = PeakFit (*)(PeakPatch const& patch);

/// Three-point Gaussian fit along each axis, Willert & Gharib, Exp. Fluids 10 (1991) 181: exact for round or
/// axis-aligned Gaussian peaks. If a neighbour is not positive, the parabola is used.
PeakFit fit_gauss3(PeakPatch const& patch);
/// Least-squares fit of a Gaussian with arbitrary axes to nine samples: log v = a + b x + c y + d x^2 + e xy + f y^2.
/// The weights v^2 convert errors of the logarithms to errors of the values. Nobach & Honkanen, Exp. Fluids 38 (2005)
/// 511; weights: Guo, IEEE Signal Process. Mag. 28 (2011) 134. If a sample is not positive, or the fit has no maximum
/// within one sample distance, fit_gauss3() is used.
PeakFit fit_gauss2d(PeakPatch const& patch);
/// Computes the vertex of the parabola through three samples along each axis.
PeakFit fit_parabola(PeakPatch const& patch);
/// Computes the centre of mass of three samples along each axis; negative samples count as zero (Raffel et al.,
/// Particle Image Velocimetry, 3rd ed. (2018), three-point estimators). The result is biased towards whole pixels,
/// because a peak is wider than three samples (Westerweel, Meas. Sci. Technol. 8 (1997) 1379); the fit is provided to
/// demonstrate this bias. Passes with image deformation remove the bias.
PeakFit fit_centroid(PeakPatch const& patch);

/// A sub-pixel fit with its properties.
struct SubpixelMethod {
  char const* name;
  SubpixelFit fit;
  bool on_gpu = false;       ///< whether the CUDA correlator supports it
  bool nine_points = false;  ///< whether it uses all nine samples of a PeakPatch, not only those along the axes
};

/// Returns the names of the fits.
std::vector<std::string> subpixel_fits();

/// Returns the fit of that name. @pre name is one of subpixel_fits()
SubpixelMethod const& subpixel_method(std::string const& name);

}  // namespace gladstone::inline correlation
