#include "analysis/tracking/dot_tracking.h"

#include <fmt/format.h>

#include <cmath>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::tracking {

std::vector<Vec2d> centres_of(LocatedDots const& located) {
  std::vector<Vec2d> centres;
  for (LocatedDot const& dot : located.dots) centres.push_back(dot.image.centre);
  return centres;
}

DisplacementField matched_vectors(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches) {
  GLADSTONE_EXPECTS(matches.size() == a.dots.size());
  Vec2d const unknown{not_a_number, not_a_number};
  DisplacementField field;
  std::size_t ambiguous = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    DotMatch const& match = matches[i];
    LocatedDot const& here = a.dots[i];
    bool const found = match.status != MatchStatus::unmatched, valid = match.status == MatchStatus::matched;
    Vec2d displacement = unknown, sigma = unknown;
    if (found) {
      LocatedDot const& there = b.dots[match.partner];
      displacement = there.image.centre - here.image.centre;
      sigma = {std::hypot(here.sigma_px.x, there.sigma_px.x), std::hypot(here.sigma_px.y, there.sigma_px.y)};
    }
    field.position_px.push_back(valid ? here.image.centre + 0.5 * displacement : here.image.centre);
    field.displacement_px.push_back(valid ? displacement : unknown);
    field.raw_px.push_back(displacement);
    field.sigma_px.push_back(valid ? sigma : unknown);
    field.correlation.push_back(found ? match.support : not_a_number);
    field.peak_ratio.push_back(found && match.other_support > 0 ? match.support / match.other_support : not_a_number);
    field.status.push_back(valid ? VectorStatus::valid : VectorStatus::invalid);
    field.reason.push_back(valid ? VectorReason::measured
                                 : (found ? VectorReason::not_replaced : VectorReason::beyond_limit));
    field.failed.push_back(match.status == MatchStatus::outlier ? FailedTest::median : FailedTest::none);
    field.ambiguous.push_back(match.status == MatchStatus::ambiguous ? Ambiguity::here : Ambiguity::none);
    ambiguous += match.status == MatchStatus::ambiguous ? 1 : 0;
  }
  if (2 * ambiguous > matches.size())
    field.warnings.push_back(
        fmt::format("{} of {} dots have ambiguous displacements (the pattern matches itself after a shift within the "
                    "search range); "
                    "use a random pattern, or state a bound of the displacement below half the pitch",
                    ambiguous, matches.size()));
  return field;
}

DisplacementField track_dots(Image<double> const& a, Image<double> const& b, DisplacementField const& predictor,
                             TrackingSettings const& settings) {
  if (a.columns() != b.columns() || a.rows() != b.rows())
    throw DataError("frame B", fmt::format("has {}x{} px, but frame A has {}x{} px; give frames of one size",
                                           b.columns(), b.rows(), a.columns(), a.rows()));
  LocatedDots const dots_a = locate_dots(a, settings.dots), dots_b = locate_dots(b, settings.dots);
  std::vector<Vec2d> const centres_a = centres_of(dots_a), centres_b = centres_of(dots_b);
  std::vector<Vec2d> prediction;
  if (predictor.size() > 0) prediction = interpolate_vectors(predictor, centres_a).displacement_px;
  return matched_vectors(dots_a, dots_b, match_dots(centres_a, centres_b, prediction, settings.matching));
}

}  // namespace gladstone::tracking
