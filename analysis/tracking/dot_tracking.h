#pragma once

#include "analysis/tracking/dot_location.h"
#include "analysis/tracking/dot_matching.h"
#include "analysis/tracking/located_frames.h"
#include "analysis/tracking/track_frames.h"
#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline tracking {

/// Settings of track_dots().
struct TrackingSettings {
  DotSettings dots;
  MatchSettings matching;
  /// Places of all dots in frame A, for example of the known pattern of a BOS target, within about one standard
  /// deviation of a dot image [px]; empty: dots are found in the frames.
  std::vector<Vec2d> known_places_px;
};

/// Measures the displacement of every dot (BOS) or particle (PIV) between two frames.
///
/// If places are known, the dots of frame A are fitted at these places. Those of frame B are first located without
/// known places, and then fitted again: at the places of the matched dots, and at the predicted places of the others.
/// Overlapping images are thus resolved into the same dots in both frames (prior knowledge of the pattern: Rajendran,
/// Bane & Vlachos, Exp. Fluids 60 (2019) 162).
/// @param predictor  field that predicts the displacements, for example the result of a correlation; masked and invalid
///                  vectors are ignored; without vectors, the prediction is zero
/// @return one vector per dot of frame A (see matched_vectors()), with warnings on dots without a valid vector
/// @throws DataError if the sizes of the frames differ; Interrupted
DisplacementField track_dots(Image<double> const& a, Image<double> const& b, DisplacementField const& predictor,
                             TrackingSettings const& settings = {});

/// Tracks dots like track_dots() above in a sequence. Uses tracks through the frames before and after the pair if these
/// frames exist (match_dots()).
/// @param located  locates the dots of the frames, with settings.dots
DisplacementField track_dots(TrackFrames const& frames, DisplacementField const& predictor,
                             TrackingSettings const& settings, LocatedFrames const& located);

/// Converts matches to a displacement field.
///
/// Vectors are at the mid-positions of the dots, as those of a correlation; dots without a valid match are at their
/// place in frame A, with a displacement of NaN. sigma_px is computed by displacement_sigmas(). Status and reason:
/// - matched: valid, measured;
/// - unmatched: invalid, beyond_limit;
/// - ambiguous: invalid, not_replaced, Ambiguity::here; raw_px is the displacement of the best candidate;
/// - outlier: invalid, not_replaced, FailedTest::median; raw_px is the displacement of the match.
/// `correlation` is the support of the match and `peak_ratio` the ratio of the best displacement's support to that of
/// the next best one.
/// @pre there is one match per dot of a
DisplacementField matched_vectors(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches);

/// Returns the centres of located dots [px].
std::vector<Vec2d> dot_centres(LocatedDots const& located);

}  // namespace gladstone::inline tracking
