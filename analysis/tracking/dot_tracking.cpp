#include "analysis/tracking/dot_tracking.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "analysis/tracking/pair_misfit.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/point_cells.h"

namespace gladstone::inline tracking {

std::vector<Vec2d> dot_centres(LocatedDots const& located) {
  std::vector<Vec2d> centres;
  for (LocatedDot const& dot : located.dots) centres.push_back(dot.image.centre);
  return centres;
}

DisplacementField matched_vectors(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches) {
  GLADSTONE_EXPECTS(matches.size() == a.dots.size());
  Vec2d const unknown{not_a_number, not_a_number};
  std::vector<Vec2d> const sigmas = displacement_sigmas(a, b, matches);
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
      sigma = sigmas[i];
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
  if (a.dots.empty() || b.dots.empty())
    field.warnings.push_back(
        {WarningCode::unreliable, "",
         fmt::format("no dots in frame {} (nothing exceeds the noise by {:g} standard deviations as a dot); check the "
                     "frames, and correlate.tracking.polarity and diameter_px",
                     a.dots.empty() ? "A" : "B", DotSettings{}.detection_threshold)});
  if (2 * ambiguous > matches.size())
    field.warnings.push_back(
        {WarningCode::unreliable, "",
         fmt::format("{} of {} dots have ambiguous displacements (the pattern matches itself after a shift within the "
                     "search range); use a random pattern, or set correlate.tracking.displacement_bound_px below half "
                     "the pitch if no displacement is larger",
                     ambiguous, matches.size())});
  return field;
}

namespace {

/// Interpolates the predicted displacements at the given places; empty if the predictor has no vectors.
std::vector<Vec2d> predict(DisplacementField const& predictor, std::span<Vec2d const> places) {
  return predictor.size() > 0 ? interpolate_vectors(predictor, places).displacement_px : std::vector<Vec2d>{};
}

/// Returns the expected places of the dots of frame A in frame B: the places of their partners, or the predicted places
/// of dots without a partner. Adds the dots of frame B that are far from all of these places and may have entered the
/// frame.
std::vector<Vec2d> expected_places(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches) {
  std::vector<Vec2d> const centres_a = dot_centres(a);
  std::vector<Vec2d> const displacements = predict(matched_vectors(a, b, matches), centres_a);
  std::vector<Vec2d> places;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    bool const matched = matches[i].status == MatchStatus::matched;
    Vec2d const place = matched ? b.dots[matches[i].partner].image.centre : centres_a[i] + displacements[i];
    if (is_finite(place)) places.push_back(place);
  }
  double const apart = 0.75 * b.diameter_px;
  PointCells const cells(places, std::max(apart, 1.0));
  for (Vec2d const centre : dot_centres(b)) {
    bool near = false;
    cells.for_near(centre, apart, [&](std::size_t k) { near = near || length(places[k] - centre) < apart; });
    if (!near) places.push_back(centre);
  }
  return places;
}

/// Tracks the dots between frames a and b. @param before, after frames before a and after b; null: none
DisplacementField track(Image<double> const* before, Image<double> const& a, Image<double> const& b,
                        Image<double> const* after, DisplacementField const& predictor,
                        TrackingSettings const& settings, LocatedFrames const& located) {
  if (a.columns() != b.columns() || a.rows() != b.rows())
    throw DataError(ErrorCode::wrong_shape, "frame B",
                    fmt::format("has {}x{} px, but frame A has {}x{} px; give frames of one size", b.columns(),
                                b.rows(), a.columns(), a.rows()));
  bool const known = !settings.known_places_px.empty();
  std::array<Image<double> const*, 4> const frames{known ? nullptr : &a, &b, before, after};
  std::vector<LocatedFrames::Located> const found = located.locate(frames);
  auto const dots_a =
      known ? std::make_shared<LocatedDots const>(locate_dots_near(a, settings.dots, settings.known_places_px))
            : found[0];
  LocatedFrames::Located dots_b = found[1];
  auto const centres_of = [](LocatedFrames::Located const& dots) {
    return dots ? dot_centres(*dots) : std::vector<Vec2d>{};
  };
  std::vector<Vec2d> const earlier = centres_of(found[2]), later = centres_of(found[3]);
  std::vector<Vec2d> const centres_a = dot_centres(*dots_a), prediction = predict(predictor, centres_a);
  auto const match = [&] {
    return match_dots(centres_a, dot_centres(*dots_b), prediction, settings.matching, {earlier, later});
  };
  std::vector<DotMatch> matches = match();
  if (known) {
    dots_b = std::make_shared<LocatedDots const>(
        locate_dots_near(b, settings.dots, expected_places(*dots_a, *dots_b, matches)));
    matches = match();
  }
  return matched_vectors(*dots_a, *dots_b, matches);
}

}  // namespace

DisplacementField track_dots(Image<double> const& a, Image<double> const& b, DisplacementField const& predictor,
                             TrackingSettings const& settings) {
  return track(nullptr, a, b, nullptr, predictor, settings, LocatedFrames(settings.dots, 1));
}

DisplacementField track_dots(TrackFrames const& frames, DisplacementField const& predictor,
                             TrackingSettings const& settings, LocatedFrames const& located) {
  auto const pointer = [](std::optional<Image<double>> const& frame) { return frame ? &*frame : nullptr; };
  return track(pointer(frames.before()), frames.reference(), frames.flow(), pointer(frames.after()), predictor,
               settings, located);
}

}  // namespace gladstone::inline tracking
