#pragma once

#include <span>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline tracking {

/// Order of the polynomial that is fitted under the window. The weighted mean is biased by a gradient where the vectors
/// are not symmetric about the point; the plane reproduces linear fields. For a front of the displacement (tanh) with a
/// width of 12 to 48 px, and vectors at distances of 7 px, the error of the plane is 0.3 to 0.7 times that of the mean,
/// and both errors are smallest near H = 1.24 spacings.
enum class WindowOrder { mean, plane };

/// Settings of the adaptive Gaussian window.
struct GaussianWindow {
  WindowOrder order = WindowOrder::plane;
  double width_over_spacing = 1.24;  ///< ratio of the width H to the local spacing of the vectors [1]
  double farthest_over_spacing = 3;  ///< largest distance of a point from its nearest vector, in mean spacings [1]
};

/// Interpolates scattered vectors by the adaptive Gaussian window of Agui & Jimenez, J. Fluid Mech. 185 (1987) 447.
///
/// The weight of a vector at the distance r is exp(-r^2 / H^2) with H = 1.24 times the mean spacing of the vectors. The
/// spacing is defined as sqrt(area / (pi count)) of the circle through the eighth nearest vector; for this definition
/// the measured optimum of H is near the same factor (see WindowOrder). Other implementations use sqrt(area / count). A
/// mean thus contains 2 pi H^2 / area per vector = 3.1 vectors on average. Unlike in the source, a plane may be fitted
/// instead of the weighted mean. If its value would be noisier than a single vector, for example at edges, the window
/// is widened up to threefold; if this does not suffice, the mean is used.
/// @param vectors  scattered vectors; masked and invalid ones (see DisplacementField::counts()) are ignored
/// @param points  positions at which the displacement is interpolated [px]
/// @return one vector per point, in their order. sigma_px is propagated from the uncertainties of the vectors, whose
/// errors are assumed to be independent; it does not include the bias caused by smoothing. A point without a vector
/// near it (farthest_over_spacing), or that is not finite, has status invalid and NaN.
DisplacementField interpolate_vectors(DisplacementField const& vectors, std::span<Vec2d const> points,
                                      GaussianWindow const& window = {});

}  // namespace gladstone::inline tracking
