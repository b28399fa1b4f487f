#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "analysis/tracking/gaussian_window.h"
#include "analysis/tracking/outlier_test.h"
#include "analysis/tracking/track_evidence.h"

namespace gladstone::inline tracking {

/// Result of the search for the partner of a dot.
enum class MatchStatus {
  matched,
  unmatched,  ///< no dot of frame B within the search radius has a displacement that the neighbours support
  ambiguous,  ///< another displacement has (nearly) the same support as the best one
  outlier,    ///< the displacement differs from those of the neighbours
};

/// Partner of a dot of frame A in frame B.
struct DotMatch {
  std::size_t partner = 0;  ///< index of the partner in frame B; undefined if unmatched
  MatchStatus status = MatchStatus::unmatched;
  /// Fraction of the neighbours that have a partner at the same displacement, increased by the evidence of a track, 0
  /// to 1 [1].
  double support = 0;
  double other_support = 0;  ///< highest support of any other displacement, 0 to 1 [1]
  /// Evidence that the match is part of a track through the frames before and after the pair, 0 to 1 [1].
  double track = 0;
};

/// Settings of match_dots(). Lengths of 0 are derived from the mean spacing of the dots of frame A.
struct MatchSettings {
  double search_radius_px = 0;  ///< largest deviation of a displacement from its prediction [px]; 0: 0.75 spacings
  /// Known upper bound of the deviation from the prediction [px]. Without a bound, displacements beyond the search
  /// radius count as alternatives, so that a regular pattern remains ambiguous. If the bound is wrong, aliases are
  /// accepted.
  double displacement_bound_px = std::numeric_limits<double>::infinity();
  /// Standard deviation of the displacements of neighbouring dots [px]; 0: 0.15 spacings.
  double tolerance_px = 0;
  double least_support = 0.35;  ///< smallest support of a match [1]
  /// Smallest ratio of another displacement's support to that of the best displacement at which a match is ambiguous
  /// [1].
  double ambiguity_ratio = 0.75;
  OutlierTest outliers;
};

/// Matches the dots of two frames: the displacement of a dot must be close to its prediction and agree with the
/// displacements of the neighbouring dots.
///
/// Every dot of frame B within the search radius of the predicted place is a candidate. Its support is the fraction of
/// the twelve nearest dots of frame A that have a dot of frame B at the same deviation from the prediction, each
/// weighted by exp(-e^2 / (2 tolerance^2)), where e is the distance between the two deviations (two-frame relaxation
/// methods: Baek & Lee, Exp. Fluids 22 (1996) 23; Ohmi & Li, Meas. Sci. Technol. 11 (2000) 603). The candidate with the
/// highest support is the match. A match is ambiguous if another displacement within the search radius plus 1.5
/// spacings has nearly the same support: a regular pattern, which matches itself after a shift by its pitch, is
/// ambiguous unless displacement_bound_px excludes that shift.
///
/// Further rounds, with half the tolerance, interpolate the prediction from the certain matches by an adaptive Gaussian
/// window, until no more matches are found. Finally, deviations from this prediction are tested against the neighbours
/// (find_outliers()). Without a given prediction, displacement gradients of up to 0.1 px/px are resolved.
///
/// In a sequence, the frames before and after the pair identify displacements that differ from those of the
/// neighbouring dots: the evidence t of a track (TrackEvidence) raises the support s of a candidate to s + 0.4 t (1 -
/// s), and matches with t of at least 0.5 are not tested against their neighbours.
/// @param a,  b        centres of the dots of frames A and B [px]; for BOS, a may be the known pattern
/// @param prediction  displacement of each dot of a [px], for example of a correlation (interpolate_vectors()); empty:
///                    zero for all dots; NaN: zero for this dot
/// @param neighbours  dots of the frames before and after the pair
/// @return one match per dot of a; no partner is used twice among matches with status `matched`
/// @pre prediction is empty or as long as a
/// @throws Interrupted
std::vector<DotMatch> match_dots(std::span<Vec2d const> a, std::span<Vec2d const> b, std::span<Vec2d const> prediction,
                                 MatchSettings const& settings = {}, TrackNeighbours const& neighbours = {});

}  // namespace gladstone::inline tracking
