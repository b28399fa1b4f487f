#include "analysis/tracking/dot_matching.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/tracking/nearest_points.h"
#include "render/base/contracts.h"
#include "render/base/median.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline tracking {
namespace {

constexpr std::size_t supporters = 12;  // number of neighbours that may support a displacement
// minimum number of neighbours for which the support of a displacement is conclusive
constexpr std::size_t least_supporters = 3;
constexpr int most_rounds = 5;  // largest number of rounds that predict from certain matches
// weight of the evidence of a track; it is small, so that the neighbours decide in coherent flows
constexpr double track_weight = 0.4;
constexpr double certain_track = 0.5;  // track evidence from which a match is not tested against its neighbours
constexpr double alias_range = 1.5;    // range of alternatives beyond the search radius [spacings]

/// Parameters of a round of the matching.
struct Round {
  std::vector<Vec2d> prediction;  ///< displacement of each dot of frame A [px]
  double radius;                  ///< largest deviation of a match from its prediction [px]
  double range;                   ///< largest deviation of the alternatives that can make a match ambiguous [px]
  double tolerance;               ///< standard deviation of the displacements of neighbouring dots [px]
};

class DotMatcher {
 public:
  DotMatcher(std::span<Vec2d const> a, std::span<Vec2d const> b, MatchSettings const& settings,
             TrackNeighbours const& neighbours)
      : a_(a),
        b_(b),
        settings_(settings),
        cells_a_(a),
        cells_b_(b),
        radius_(settings.search_radius_px > 0 ? settings.search_radius_px : 0.75 * cells_a_.spacing()),
        tolerance_(settings.tolerance_px > 0 ? settings.tolerance_px : 0.15 * cells_a_.spacing()),
        tracks_(neighbours, radius_, tolerance_),
        around_(a.size()) {
    parallel_chunks(a.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        around_[i] = cells_a_.nearest(a_[i], supporters + 1, 8 * cells_a_.spacing());
        std::erase(around_[i], i);
        around_[i].resize(std::min(around_[i].size(), supporters));
      }
    });
  }

  std::vector<DotMatch> run(std::span<Vec2d const> prediction) const {
    double const spacing = cells_a_.spacing(), bound = settings_.displacement_bound_px;
    std::vector<Vec2d> given(a_.size());
    for (std::size_t i = 0; i < prediction.size(); ++i)
      if (is_finite(prediction[i])) given[i] = prediction[i];
    Round round{given, std::min(radius_, bound), std::min(radius_ + alias_range * spacing, bound), tolerance_};
    std::vector<DotMatch> matches = match(round);

    // Predict again from the certain matches, whose number increases around the regions of good prediction.
    for (int repeat = 0; repeat < most_rounds; ++repeat) {
      std::size_t const before = count_certain(matches);
      if (before <= least_supporters) return matches;
      std::vector<char> const outliers =
          find_outliers(a_, deviations(matches, refine_prediction(given, matches, {})), settings_.outliers);
      round.prediction = refine_prediction(given, matches, outliers);
      round.tolerance = 0.5 * tolerance_;
      matches = match(round);
      for (std::size_t i = 0; i < a_.size(); ++i)  // the search radius refers to the prediction given by the caller
        if (matches[i].status == MatchStatus::matched &&
            !(length(match_deviation(i, matches[i], given[i])) <= round.radius))
          matches[i].status = MatchStatus::unmatched;
      if (static_cast<double>(count_certain(matches)) < 1.01 * static_cast<double>(before)) break;
    }
    resolve_close_pairs(matches, round);
    std::vector<char> const outliers = find_outliers(a_, deviations(matches, round.prediction), settings_.outliers);
    for (std::size_t i = 0; i < a_.size(); ++i)
      if (outliers[i] && matches[i].track < certain_track) matches[i].status = MatchStatus::outlier;
    return matches;
  }

 private:
  static std::size_t count_certain(std::vector<DotMatch> const& matches) {
    return static_cast<std::size_t>(std::count_if(
        matches.begin(), matches.end(), [](DotMatch const& match) { return match.status == MatchStatus::matched; }));
  }

  /// Returns the displacement of dot i to its partner minus a prediction.
  Vec2d match_deviation(std::size_t i, DotMatch const& match, Vec2d prediction) const {
    return b_[match.partner] - a_[i] - prediction;
  }

  /// Returns the deviations of all dots' displacements from a prediction; NaN for dots without a certain match.
  std::vector<Vec2d> deviations(std::vector<DotMatch> const& matches, std::vector<Vec2d> const& prediction) const {
    std::vector<Vec2d> values(a_.size(), Vec2d{not_a_number, not_a_number});
    for (std::size_t i = 0; i < a_.size(); ++i)
      if (matches[i].status == MatchStatus::matched) values[i] = match_deviation(i, matches[i], prediction[i]);
    return values;
  }

  /// Computes a new prediction by interpolation of the certain matches that are not outliers; far from these matches,
  /// retains the given prediction.
  /// @param outliers  as returned by find_outliers(); empty: none
  std::vector<Vec2d> refine_prediction(std::vector<Vec2d> prediction, std::vector<DotMatch> const& matches,
                                       std::vector<char> const& outliers) const {
    DisplacementField certain;
    for (std::size_t i = 0; i < a_.size(); ++i) {
      if (matches[i].status != MatchStatus::matched || (!outliers.empty() && outliers[i])) continue;
      certain.position_px.push_back(a_[i]);
      certain.displacement_px.push_back(b_[matches[i].partner] - a_[i]);
    }
    DisplacementField const refined = interpolate_vectors(certain, a_);
    for (std::size_t i = 0; i < a_.size(); ++i)
      if (refined.counts(i)) prediction[i] = refined.displacement_px[i];
    return prediction;
  }

  /// Matches ambiguous dots again with a smaller tolerance, to distinguish candidates that are close to each other. The
  /// tolerance is three times the median deviation of the certain matches from their prediction.
  void resolve_close_pairs(std::vector<DotMatch>& matches, Round round) const {
    std::vector<double> sizes;
    std::vector<char> taken(b_.size());
    for (std::size_t i = 0; i < a_.size(); ++i) {
      if (matches[i].status != MatchStatus::matched) continue;
      sizes.push_back(length(match_deviation(i, matches[i], round.prediction[i])));
      taken[matches[i].partner] = 1;
    }
    if (sizes.empty()) return;
    round.tolerance = std::clamp(3 * upper_median(std::move(sizes)), 0.01 * cells_a_.spacing(), round.tolerance);
    std::vector<DotMatch> const closer = match(round);
    for (std::size_t i = 0; i < a_.size(); ++i) {
      bool const resolved = matches[i].status == MatchStatus::ambiguous && closer[i].status == MatchStatus::matched;
      if (!resolved || taken[closer[i].partner]) continue;
      matches[i] = closer[i];
      taken[closer[i].partner] = 1;
    }
  }

  /// Returns the support of a deviation of dot i from its prediction, see match_dots().
  double support(std::size_t i, Vec2d deviation, Round const& round) const {
    double sum = 0;
    for (std::size_t const k : around_[i]) {
      double const e = cells_b_.distance(a_[k] + round.prediction[k] + deviation, 3 * round.tolerance);
      if (std::isfinite(e)) sum += std::exp(-0.5 * e * e / (round.tolerance * round.tolerance));
    }
    return sum / static_cast<double>(around_[i].size());
  }

  DotMatch best_match(std::size_t i, Round const& round) const {
    DotMatch match;
    if (!is_finite(a_[i])) return match;
    Vec2d const place = a_[i] + round.prediction[i];
    std::vector<std::size_t> const candidates = cells_b_.within(place, round.range);
    if (around_[i].size() < least_supporters) {
      // Without neighbours, a match is certain only if there is a single candidate.
      if (candidates.empty() || !(length(b_[candidates.front()] - place) <= round.radius)) return match;
      match.partner = candidates.front();
      match.status = candidates.size() == 1 ? MatchStatus::matched : MatchStatus::ambiguous;
      return match;
    }
    bool any = false;
    for (std::size_t const k : candidates) {
      Vec2d const deviation = b_[k] - place;
      bool const near = length(deviation) <= round.radius;
      double const track = near ? tracks_.evaluate(a_[i], b_[k] - a_[i]) : 0.0;
      double const shared = support(i, deviation, round), own = shared + (1 - shared) * track_weight * track;
      if (near && (!any || own > match.support)) {
        if (any) match.other_support = std::max(match.other_support, match.support);
        match.support = own;
        match.track = track;
        match.partner = k;
        any = true;
      } else {
        match.other_support = std::max(match.other_support, own);
      }
    }
    if (!any || match.support < settings_.least_support) return match;
    match.status =
        match.other_support < settings_.ambiguity_ratio * match.support ? MatchStatus::matched : MatchStatus::ambiguous;
    return match;
  }

  std::vector<DotMatch> match(Round const& round) const {
    std::vector<DotMatch> matches(a_.size());
    parallel_chunks(a_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) matches[i] = best_match(i, round);
    });
    // If several dots have the same partner, assign it to the dot whose prediction it fits best.
    std::vector<std::size_t> owner(b_.size(), a_.size());
    auto const misfit = [&](std::size_t i) { return length(match_deviation(i, matches[i], round.prediction[i])); };
    for (std::size_t i = 0; i < a_.size(); ++i) {
      if (matches[i].status != MatchStatus::matched) continue;
      std::size_t& own = owner[matches[i].partner];
      if (own == a_.size()) {
        own = i;
        continue;
      }
      bool const closer = misfit(i) < misfit(own);
      matches[closer ? own : i].status = MatchStatus::unmatched;
      if (closer) own = i;
    }
    return matches;
  }

  std::span<Vec2d const> a_, b_;
  MatchSettings settings_;
  NearestPoints cells_a_, cells_b_;
  double radius_, tolerance_;  // search radius, and standard deviation of the displacements of neighbouring dots [px]
  TrackEvidence tracks_;
  std::vector<std::vector<std::size_t>> around_;  // nearest dots of each dot of frame A
};

}  // namespace

std::vector<DotMatch> match_dots(std::span<Vec2d const> a, std::span<Vec2d const> b, std::span<Vec2d const> prediction,
                                 MatchSettings const& settings, TrackNeighbours const& neighbours) {
  GLADSTONE_EXPECTS(prediction.empty() || prediction.size() == a.size());
  if (a.empty() || b.empty()) return std::vector<DotMatch>(a.size());
  return DotMatcher(a, b, settings, neighbours).run(prediction);
}

}  // namespace gladstone::inline tracking
