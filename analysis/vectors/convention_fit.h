#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "analysis/vectors/convention_detection.h"

namespace gladstone::inline vectors {

/// Displacement at a position in our conventions [px]; NaN outside of the field of view.
using Truth = std::function<Vec2d(Vec2d)>;

/// Returns true if the axes, the signs and the order of the frames agree. The centre about which y is mirrored and the
/// offset are ignored, because they affect only the positions.
bool same_axes(VectorConventions const& a, VectorConventions const& b);

/// Selects at most `most` counted vectors at equal index intervals. The rows with the extreme y are included as masked
/// vectors, so that the centre of the grid is preserved.
DisplacementField sample(DisplacementField const& field, std::size_t most);

/// Returns a standard deviation about zero that outliers change little: the scale at which normally distributed errors
/// have the same likelihood as `errors` under Cauchy's distribution with their median magnitude. For normally
/// distributed errors this scale is their standard deviation. Magnitudes below 1e-4 px count as 1e-4 px.
double robust_spread(std::vector<double> const& errors);

/// Computes the agreement of vectors with the truth, with an upper limit of the differences.
/// @param most  upper limit of a difference [px], and the difference assumed at positions without truth, so that
///              conventions are not preferred for moving vectors out of view
ConventionFit fit_within(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                         int image_rows, double most);

/// Returns the upper limit of the differences in ConventionFit::rms_px. It limits the influence of outliers, but is
/// large enough for the differences that wrong conventions cause.
double largest_difference(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                          int image_rows);

/// Returns the smallest convention_penalty() of an interpretation relative to any of the format's own conventions.
double convention_penalty(VectorConventions const& reading, std::vector<VectorConventions> const& own);

/// Returns a penalty for the differences between an interpretation and the format's own; the likeliest interpretation
/// has the smallest. Axes and signs count 1 each, exchanged columns 1.2, the offset 0.3, the mirror 0.2; a reversal of
/// both y and v counts 1.1 in total.
double convention_penalty(VectorConventions const& reading, VectorConventions const& own);

/// Returns twice the log-likelihood ratio of fit a to fit b, for errors with the given spreads: 9 corresponds to three
/// standard deviations. At an overlap of one half, each vector shares its image with three other vectors, so that a
/// quarter of the components is assumed to be independent. Spreads below 1e-4 px count as equal.
double log_likelihood_statistic(ConventionFit const& a, ConventionFit const& b);

}  // namespace gladstone::inline vectors
