#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "analysis/tracking/gaussian_window.h"
#include "analysis/tracking/outlier_test.h"
#include "analysis/tracking/track_evidence.h"

namespace gladstone::tracking {

/// Result of the search for the partner of a dot.
enum class MatchStatus {
  matched,
  unmatched,  ///< no dot within the search radius has a displacement that the neighbours support
  ambiguous,  ///< another displacement has (nearly) the same support
  outlier,    ///< differs from its neighbours
};

/// Partner of a dot of frame A in frame B.
struct DotMatch {
  std::size_t partner = 0;  ///< index in frame B; meaningless if unmatched
  MatchStatus status = MatchStatus::unmatched;
  /// share of the neighbours that have a partner at the same displacement, raised by the evidence of a track, 0 to 1
  double support = 0;
  double other_support = 0;  ///< highest support of another displacement, 0 to 1
  double track = 0;          ///< evidence of a track through the frames before and after, 0 to 1
};

/// Settings of match_dots(). Lengths of 0 are derived from the mean spacing of the dots of frame A.
struct MatchSettings {
  double search_radius_px = 0;  ///< largest deviation of a displacement from its prediction [px]; 0: 0.75 spacings
  /// Deviation from the prediction that is known not to be exceeded [px]. Without it, displacements beyond the search
  /// radius count as alternatives, so that a regular pattern remains ambiguous. A wrong bound lets aliases pass.
  double displacement_bound_px = std::numeric_limits<double>::infinity();
  double tolerance_px = 0;        ///< standard deviation of neighbours' displacements [px]; 0: 0.15 spacings
  double least_support = 0.35;    ///< smallest support of a match [1]
  double ambiguity_ratio = 0.75;  ///< smallest ratio of the supports of another and of the best displacement that makes
                                  ///< a match ambiguous
  OutlierTest outliers;
};

/// Matches the dots of two frames by their prediction and by their neighbours.
///
/// Every dot of frame B within the search radius of the predicted place is a candidate. Its support is the share of the
/// twelve nearest dots of frame A that have a dot of frame B at the same deviation from the prediction, each weighted
/// by exp(-e^2 / (2 tolerance^2)) of its distance e (two-frame relaxation methods: Baek & Lee, Exp. Fluids 22 (1996)
/// 23; Ohmi & Li, Meas. Sci. Technol. 11 (2000) 603). The candidate with the highest support is the match. A match is
/// ambiguous if another displacement within the search radius plus 1.5 spacings has nearly the same support: a regular
/// pattern, which matches itself after a shift by its pitch, is ambiguous unless displacement_bound_px excludes that
/// shift.
///
/// Further rounds, with half the tolerance, predict from the certain matches by an adaptive Gaussian window, until no
/// more matches are found. Finally, deviations from this prediction are tested against the neighbours
/// (find_outliers()). Without a prediction, gradients up to 0.1 px/px are resolved.
///
/// In a sequence, the frames before and after resolve displacements that neighbours do not share: the evidence t of a
/// track (TrackEvidence) raises the support s of a candidate to s + 0.4 t (1 - s), and matches with t of at least
/// 0.5 are not tested against their neighbours.
/// @param a, b        centres of the dots of frames A and B [px]; for BOS, a may be the known pattern
/// @param prediction  displacement of each dot of a [px], for example of a correlation (interpolate_vectors()); empty:
///                    zero; NaN: zero for this dot
/// @param neighbours  dots of the frames before and after
/// @return one match per dot of a; no partner is used twice among matches with status `matched`
/// @pre prediction is empty or as long as a
/// @throws Interrupted
std::vector<DotMatch> match_dots(std::span<Vec2d const> a, std::span<Vec2d const> b, std::span<Vec2d const> prediction,
                                 MatchSettings const& settings = {}, TrackNeighbours const& neighbours = {});

}  // namespace gladstone::tracking
