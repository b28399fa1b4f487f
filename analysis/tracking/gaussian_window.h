#pragma once

#include <span>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::tracking {

/// Order of the polynomial that is fitted under the window. The weighted mean is biased by a gradient where the vectors
/// are not symmetric about the point; the plane reproduces linear fields. On a front (tanh) of 12 to 48 px width, with
/// vectors 7 px apart, the error of the plane is 0.3 to 0.7 of that of the mean, and both are smallest near H = 1.24
/// spacings.
enum class WindowOrder { mean, plane };

/// Settings of the adaptive Gaussian window.
struct GaussianWindow {
  WindowOrder order = WindowOrder::plane;
  double width_over_spacing = 1.24;  ///< H over the local spacing of the vectors [1]
  double farthest_over_spacing = 3;  ///< largest distance of the nearest vector over the mean spacing [1]
};

/// Interpolates scattered vectors by the adaptive Gaussian window of Agui & Jimenez, J. Fluid Mech. 185 (1987) 447.
///
/// The weight of a vector at the distance r is exp(-r^2 / H^2) with H = 1.24 times the mean spacing of the vectors. The
/// spacing is defined as sqrt(area / (pi count)) of the circle through the eighth nearest vector; for this definition
/// the measured optimum of H is near the same factor (see WindowOrder). Other implementations use sqrt(area / count). A
/// mean thus contains 2 pi H^2 / area per vector = 3.1 vectors on average. The plane instead of the weighted mean is an
/// addition to the source; where it would be noisier than a single vector, as at edges, its window is widened up to
/// threefold, and beyond that the mean is used.
/// @param vectors  vectors that do not count (DisplacementField::counts()) are ignored
/// @param points   [px]
/// @return one vector per point, in their order. sigma_px is propagated from that of the vectors, as independent
/// errors; it does not contain the smoothing of the displacement. A point without a vector near it
/// (farthest_over_spacing), or that is not finite, has status invalid and NaN.
DisplacementField interpolate_vectors(DisplacementField const& vectors, std::span<Vec2d const> points,
                                      GaussianWindow const& window = {});

}  // namespace gladstone::tracking
