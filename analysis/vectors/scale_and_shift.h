#pragma once

#include <vector>

#include "analysis/vectors/convention_fit.h"

namespace gladstone::inline vectors {

/// Applies a correction to the vectors of a file.
DisplacementField corrected(DisplacementField field, VectorCorrection const& correction);

/// Returns true if no displacement of a field differs from 0.
bool is_zero(DisplacementField const& field);

/// Returns the fraction of the displacement that windows of the given size measure: the regression slope of the truth
/// averaged over windows on the truth at their centres, for each component, at most 1. A sample of at most 500 vectors
/// is used.
Vec2d share_in_windows(DisplacementField const& ours, Truth const& truth, double window_px);

/// Common input of the searches for a correction.
struct Search {
  DisplacementField const& few;  ///< sample of the file's vectors
  Truth const& truth;
  int image_rows;
  double most;  ///< upper limit of the difference between a vector and the truth [px], see fit_within()
  ConventionFit own;

  /// Returns the fit of `field`, a part of `few`, after a correction.
  ConventionFit fit(DisplacementField const& field, VectorCorrection const& correction) const {
    return fit_within(corrected(field, correction), own.conventions, truth, image_rows, most);
  }
  /// Returns true if a correction halves the spread and the improvement is significant at five standard deviations.
  /// Vectors with random factors are on average too long, but no common factor halves their error.
  bool is_improved(ConventionFit const& other) const {
    return other.spread_px < 0.5 * own.spread_px && other.spread_px < 0.7 * other.signal_spread_px &&
           log_likelihood_statistic(other, own) > 25.0;
  }
};

/// Searches for a factor or offset of the displacements and a shift or factor of the positions with the conventions in
/// use, and returns the one that fits best. If none fits and `any_reading` is true, also searches for a factor in
/// combination with all other conventions.
ProbableMistake find_scale_or_shift(Search search, std::vector<ConventionFit> const& fits,
                                    std::vector<VectorConventions> const& own, bool any_reading);

}  // namespace gladstone::inline vectors
