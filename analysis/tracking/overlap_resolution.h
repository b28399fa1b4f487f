#pragma once

#include "analysis/tracking/dot_fit.h"

namespace gladstone::inline tracking {

/// Smallest distance between two dots, in standard deviations of their images; closer dots are treated as one dot.
inline constexpr double closest_over_sigma = 0.35;

/// Model of the dots of a frame, for fits of groups.
struct DotModel {
  DotShape shape = DotShape::round;
  DotPrior prior;
  double mismatch = 0;             ///< rms deviation of dot images from the Gaussian, relative to their level [1]
  double detection_threshold = 5;  ///< smallest flux of a dot, in standard uncertainties [1]
};

/// Fits a group of dots and adds dots while this decreases the sum of squares significantly: by 25 or more, which noise
/// alone does with a probability of about 1e-4 (chi2 of three parameters). A new dot is placed at the largest residual
/// or by splitting one of the three dots with the worst residual along the principal axis of its second moments. In
/// this test, the deviation of dot images from the Gaussian counts as noise, so that a single dot of unusual shape is
/// not fitted by several dots.
/// @param most_additions  largest number of added dots; 0: the given dots are fitted without additions
/// @return the fit with the accepted dots, weighted by the noise alone
DotFit fit_overlapping_dots(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotModel const& model,
                            int most_additions);

}  // namespace gladstone::inline tracking
