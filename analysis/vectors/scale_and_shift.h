#pragma once

#include <vector>

#include "analysis/vectors/convention_fit.h"

namespace gladstone::detail {

/// Common input of the searches for a factor and a shift.
struct Search {
  DisplacementField const& few;  ///< sample of the file's vectors
  Truth const& truth;
  int image_rows;
  double most;  ///< upper limit of a difference, see fit_within()
  ConventionFit own;

  ConventionFit fit(DisplacementField const& field) const {
    return fit_within(field, own.conventions, truth, image_rows, most);
  }
  /// Returns true if a correction reduces the rms by 30 % and the improvement is significant at five standard
  /// deviations.
  bool is_mended(ConventionFit const& other) const {
    return other.rms_px < 0.7 * own.rms_px && other.rms_px < 0.7 * other.signal_px && evidence_for(other, own) > 25.0;
  }
};

/// Searches for a factor or shift with the conventions in use. If `any_reading`, also searches for a factor with all
/// other conventions.
LikelyMistake find_scale_or_shift(Search search, std::vector<ConventionFit> const& fits,
                                  std::vector<VectorConventions> const& own, bool any_reading);

}  // namespace gladstone::detail
