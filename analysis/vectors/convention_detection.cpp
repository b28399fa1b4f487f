#include "analysis/vectors/convention_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/scale_and_shift.h"

namespace gladstone::inline vectors {
namespace {

using Exchange = VectorConventions::Exchange;
using Mirror = VectorConventions::Mirror;
using Verdict = DetectedConventions::Verdict;

/// Returns all candidate conventions. The format's own conventions come first, so that they are selected among equally
/// good ones.
std::vector<VectorConventions> every_choice(std::vector<VectorConventions> const& own) {
  std::vector<VectorConventions> choices = own;
  auto const consider = [&choices](VectorConventions const& c) {
    if (std::find(choices.begin(), choices.end(), c) == choices.end()) choices.push_back(c);
  };
  auto const consider_axes = [&](VectorConventions reading) {
    for (bool const swapped : {false, true}) {
      for (bool const v_up : {false, true}) {
        for (auto const& [y_up, mirror] :
             {std::pair(false, Mirror::grid), std::pair(true, Mirror::grid), std::pair(true, Mirror::image)}) {
          reading.swapped = swapped;
          reading.v_up = v_up;
          reading.y_up = y_up;
          reading.mirror = mirror;
          consider(reading);
        }
      }
    }
  };
  VectorConventions reading = own.front();
  for (double const offset : {own.front().offset_px, 0.0, -0.5, -1.0, -1.5}) {
    reading.offset_px = offset;
    consider_axes(reading);
  }
  reading.offset_px = own.front().offset_px;
  for (auto const exchange : {Exchange::places, Exchange::components, Exchange::axes}) {
    reading.exchange = exchange;
    consider_axes(reading);
  }
  return choices;
}

bool surely_better(ConventionFit const& a, ConventionFit const& b) {
  return a.spread_px < b.spread_px && log_likelihood_statistic(a, b) > 9.0;
}

bool better(ConventionFit const& a, ConventionFit const& b) { return a.spread_px < b.spread_px; }

/// Returns the best fit of each choice of axes and signs, in ascending order of rms.
std::vector<ConventionFit> best_of_axes(std::vector<ConventionFit> const& fits) {
  std::vector<ConventionFit> best;
  for (ConventionFit const& fit : fits) {
    auto const known = std::find_if(best.begin(), best.end(), [&](ConventionFit const& other) {
      return same_axes(other.conventions, fit.conventions);
    });
    if (known == best.end()) {
      best.push_back(fit);
    } else if (better(fit, *known)) {
      *known = fit;
    }
  }
  std::stable_sort(best.begin(), best.end(), better);
  return best;
}

Verdict judge(ConventionFit const& best) {
  // Require a slope of three standard errors, since this fit is the best of some sixty candidates.
  if (best.spread_px < best.signal_spread_px && best.slope > 3.0 * best.slope_error) return Verdict::fits;
  if (!(best.signal_px >= min_decidable_signal_px)) return Verdict::cannot_be_told;
  bool const follows = best.slope - 2.0 * best.slope_error > 0.5 && best.slope < 2.0;
  return follows ? Verdict::noisy : Verdict::no_convention_fits;
}

/// Returns true if the difference from the best fit is insignificant, or small enough to be caused by estimator errors
/// in a flow that is similar in both interpretations: 10 % of the rms for different axes, 5 % for a different offset.
bool fits_as_well(ConventionFit const& fit, ConventionFit const& best) {
  double const part = same_axes(fit.conventions, best.conventions) ? 0.95 : 0.9;
  return !(part * fit.spread_px > best.spread_px) || log_likelihood_statistic(best, fit) < 9.0;
}

/// Returns the likeliest of the conventions that fit as well as the best.
ConventionFit likeliest(std::vector<ConventionFit> const& fits, std::vector<VectorConventions> const& own) {
  ConventionFit const best = *std::min_element(fits.begin(), fits.end(), better);
  return *std::min_element(fits.begin(), fits.end(), [&](ConventionFit const& a, ConventionFit const& b) {
    auto const rank = [&](ConventionFit const& fit) {
      return fits_as_well(fit, best) ? convention_penalty(fit.conventions, own)
                                     : std::numeric_limits<double>::infinity();
    };
    return rank(a) < rank(b);
  });
}

}  // namespace

bool is_too_fine_for_windows(DisplacementField const& ours, Truth const& truth) {
  if (ours.size() == 0) return false;
  auto const& places = ours.position_px;
  auto const [left, right] =
      std::minmax_element(places.begin(), places.end(), [](Vec2d a, Vec2d b) { return a.x < b.x; });
  auto const [top, bottom] =
      std::minmax_element(places.begin(), places.end(), [](Vec2d a, Vec2d b) { return a.y < b.y; });
  double const spacing = std::sqrt((right->x - left->x) * (bottom->y - top->y) / static_cast<double>(ours.size()));
  constexpr double least_followed = 0.2;
  Vec2d const share = share_in_windows(ours, truth, std::clamp(4.0 * spacing, 16.0, 64.0));
  return std::max(share.x, share.y) < least_followed;
}

DetectedConventions detect_conventions(VectorFile const& file, Truth const& truth, int image_rows) {
  DisplacementField const few = sample(file.field, 4000);
  std::vector<VectorConventions> own = file.also;
  own.insert(own.begin(), file.conventions);
  double const most = largest_difference(few, own.front(), truth, image_rows);
  std::vector<ConventionFit> fits;
  for (VectorConventions const& choice : every_choice(own))
    fits.push_back(fit_within(few, choice, truth, image_rows, most));

  // Use the first of the format's own conventions unless another of them fits better. If they differ in the offset
  // only, a significant improvement suffices: software with image deformation measures at the nodes of its grid, but
  // half a pixel away from them with a single pass.
  DetectedConventions result;
  result.format = file.format;
  result.all_zero = is_zero(file.field);
  ConventionFit chosen = fits.front();
  for (std::size_t i = 1; i < own.size(); ++i) {
    bool const clear = same_axes(fits[i].conventions, chosen.conventions) || fits[i].spread_px < 0.9 * chosen.spread_px;
    if (clear && surely_better(fits[i], chosen)) chosen = fits[i];
  }
  result.verdict = judge(*std::min_element(fits.begin(), fits.end(), better));
  result.tried = best_of_axes(fits);
  result.best = likeliest(fits, own);
  if (result.verdict == Verdict::no_convention_fits && !is_zero(few) &&
      is_too_fine_for_windows(apply_conventions(file.field, chosen.conventions, image_rows), truth))
    result.verdict = Verdict::cannot_be_told;
  if (result.verdict == Verdict::cannot_be_told) chosen = fits.front();

  // If conventions other than the format's own fit better, the file contains a mistake, provided that the improvement
  // is large and significant. Four standard deviations are required because of the number of candidates.
  bool const reads = result.verdict == Verdict::fits || result.verdict == Verdict::noisy;
  double const clearly = same_axes(result.best.conventions, chosen.conventions) ? 0.95 : 0.9;
  bool const is_own = std::find(own.begin(), own.end(), result.best.conventions) != own.end();
  if (reads && !is_own && result.best.spread_px < clearly * chosen.spread_px &&
      log_likelihood_statistic(result.best, chosen) > 16.0) {
    auto const interpreted_as = [&](VectorConventions const& interpretation) {
      return MistakeReason{MistakeReason::Kind::interpretation, interpretation, chosen.conventions};
    };
    result.mistake = {
        {interpreted_as(result.best.conventions)}, describe(result.best.conventions), result.best, chosen};
    // add other mistakes that this displacement does not distinguish from the first one
    for (ConventionFit const& other : result.tried) {
      if (same_axes(other.conventions, result.best.conventions) || !fits_as_well(other, result.best)) continue;
      if (convention_penalty(other.conventions, own) > convention_penalty(result.best.conventions, own) + 0.5) continue;
      result.mistake.reasons.push_back(interpreted_as(other.conventions));
    }
  }
  if (result.verdict != Verdict::cannot_be_told) {
    ProbableMistake other = find_scale_or_shift({few, truth, image_rows, most, chosen}, fits, own,
                                                result.verdict == Verdict::no_convention_fits);
    if (other.found() &&
        (!result.mistake.found() || other.corrected_fit.spread_px < 0.9 * result.mistake.corrected_fit.spread_px))
      result.mistake = std::move(other);
  }
  if (result.mistake.found()) result.verdict = Verdict::mistaken;

  auto const rival = std::find_if(result.tried.begin(), result.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, chosen.conventions);
  });
  result.ambiguous = rival != result.tried.end() && !(chosen.spread_px < 0.9 * rival->spread_px) &&
                     result.verdict != Verdict::mistaken;
  result.conventions = chosen.conventions;
  result.fit = chosen;
  VectorConventions without = chosen.conventions;
  without.offset_px = 0.0;
  result.without_offset = fit_within(few, without, truth, image_rows, most);
  return result;
}

}  // namespace gladstone::inline vectors
