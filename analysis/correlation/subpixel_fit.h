#pragma once

#include <string>
#include <vector>

namespace gladstone {

/// The values around a peak's highest sample, the fall-off of the plane that the weights cause divided out.
struct PeakPatch {
  double value[3][3];  ///< row dy + 1, column dx + 1; the middle is positive and the highest
};

/// Where a peak lies between the samples.
struct PeakFit {
  double x = 0.0;         ///< from the middle sample [px], within [-1, 1]
  double y = 0.0;         ///< the same downwards
  double log_rise = 0.0;  ///< logarithm of the height there over the middle sample [1]
};

using SubpixelFit = PeakFit (*)(PeakPatch const& patch);

/// Three-point Gaussian along either axis, Willert & Gharib, Exp. Fluids 10 (1991) 181: exact for round or axis-aligned
/// Gaussian peaks. Where a neighbour is not positive the parabola stands in.
PeakFit fit_gauss3(PeakPatch const& patch);
/// Gaussian of any axes through nine points by least squares: log v = a + b x + c y + d x^2 + e xy + f y^2 with weights
/// v^2, which make the errors of the logarithms those of the values. Nobach & Honkanen, Exp. Fluids 38 (2005) 511;
/// weights: Guo, IEEE Signal Process. Mag. 28 (2011) 134. Where a value is not positive, or the form has no maximum
/// within a sample, fit_gauss3() stands in.
PeakFit fit_gauss2d(PeakPatch const& patch);
/// Vertex of the parabola through three points along either axis.
PeakFit fit_parabola(PeakPatch const& patch);
/// Centre of mass of three points along either axis, negative ones left out (Raffel et al., Particle Image Velocimetry,
/// 3rd ed. (2018), three-point estimators): pulls towards whole pixels, since a peak is wider than three points
/// (Westerweel, Meas. Sci. Technol. 8 (1997) 1379), and is here to show it. Passes that deform the frames win it back.
PeakFit fit_centroid(PeakPatch const& patch);

/// Names of the fits, in the order of their table.
std::vector<std::string> subpixel_fits();

/// Whether the correlator of CUDA has it, too. @pre one of subpixel_fits()
bool subpixel_fit_on_gpu(std::string const& name);

/// The fit of that name. @pre one of subpixel_fits()
SubpixelFit subpixel_fit(std::string const& name);

}  // namespace gladstone
