#include "analysis/vectors/scale_and_shift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/position_mistakes.h"
#include "render/base/median.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline vectors {
namespace {

/// Returns the factor between a component and its truth by least absolute deviations: the median of their ratios,
/// weighted by |truth|. The median remains correct if up to half of the vectors are wrong.
double median_factor(DisplacementField const& ours, Truth const& truth, double Vec2d::*component) {
  std::vector<std::pair<double, double>> ratios;
  double sum = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    double const t = truth(ours.position_px[i]).*component;
    if (!std::isfinite(t) || t == 0.0) continue;
    ratios.emplace_back(ours.displacement_px[i].*component / t, std::abs(t));
    sum += std::abs(t);
  }
  std::sort(ratios.begin(), ratios.end());
  double below = 0.0;
  for (auto const& [ratio, weight] : ratios) {
    below += weight;
    if (below >= 0.5 * sum) return ratio;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Returns the rms of a component of the truth [px].
double component_signal(DisplacementField const& ours, Truth const& truth, double Vec2d::*component) {
  double square = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    double const t = ours.counts(i) ? truth(ours.position_px[i]).*component : std::nan("");
    if (!std::isfinite(t)) continue;
    square += t * t;
    ++count;
  }
  return count > 0 ? std::sqrt(square / static_cast<double>(count)) : 0.0;
}

/// Searches for displacements that are a multiple of the true displacements.
ProbableMistake find_factor(Search const& search) {
  DisplacementField const ours = apply_conventions(search.few, search.own.conventions, search.image_rows);
  Vec2d const share = share_in_windows(ours, search.truth, 64.0);
  constexpr double least_followed = 0.05;  // minimum slope for which windows still follow the displacement
  auto const determines = [&](double Vec2d::*component) {
    return component_signal(ours, search.truth, component) >
           std::max(min_decidable_signal_px, 0.2 * search.own.signal_px);
  };
  Vec2d factor{1.0, 1.0};
  for (auto const component : {&Vec2d::x, &Vec2d::y}) {
    if (!determines(component)) continue;
    double const found = median_factor(ours, search.truth, component);
    if (found > 0.0 && (found > 1.05 || found < std::max(least_followed, 0.9 * (share.*component))))
      factor.*component = found;
  }
  if (factor == Vec2d{1.0, 1.0}) return {};
  // Use one factor for both components if their factors agree.
  bool const both = std::abs(factor.x - factor.y) < 0.1 * std::max(factor.x, factor.y);
  if (both) factor.x = factor.y = 0.5 * (factor.x + factor.y);
  // Apply the factors to the columns of the file, which may be exchanged.
  VectorCorrection correction;
  correction.factor = search.own.conventions.exchanges_components() ? Vec2d{factor.y, factor.x} : factor;
  ConventionFit const corrected_fit = search.fit(search.few, correction);
  if (!search.is_improved(corrected_fit)) return {};
  VectorConventions scaled = search.own.conventions;
  MistakeReason reason{MistakeReason::Kind::factor, scaled, scaled, factor};
  for (auto const component : {&Vec2d::x, &Vec2d::y})
    if (!both && !determines(component)) reason.value.*component = not_a_number;
  scaled.px_per_frame = std::stod(fmt::format("{:.3g}", scaled.px_per_frame.value_or(1.0) * factor.x));
  return {{reason}, both ? describe(scaled) : std::string(), corrected_fit, search.own, correction};
}

/// Searches for a constant that is added to all displacements.
ProbableMistake find_offset(Search const& search) {
  if (is_zero(search.few)) return {};  // otherwise an offset would explain zero vectors in a uniform displacement
  DisplacementField const ours = apply_conventions(search.few, search.own.conventions, search.image_rows);
  Vec2d offset{};
  for (auto const component : {&Vec2d::x, &Vec2d::y}) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      double const t = ours.counts(i) ? search.truth(ours.position_px[i]).*component : std::nan("");
      if (std::isfinite(t)) differences.push_back(ours.displacement_px[i].*component - t);
    }
    if (differences.empty()) return {};
    offset.*component = upper_median(std::move(differences));
  }
  constexpr double least = 0.2;  // minimum offset that is reported; larger than the bias by peak locking [px]
  if (!(std::max(std::abs(offset.x), std::abs(offset.y)) > least)) return {};
  MistakeReason const reason{MistakeReason::Kind::offset, search.own.conventions, search.own.conventions, offset};
  // Apply the offset to the columns of the file, whose signs and order may differ.
  VectorConventions const& c = search.own.conventions;
  if (c.swapped) offset = -offset;
  if (c.v_up) offset.y = -offset.y;
  VectorCorrection correction;
  correction.offset_px = c.exchanges_components() ? Vec2d{offset.y, offset.x} : offset;
  ConventionFit const corrected_fit = search.fit(search.few, correction);
  if (!search.is_improved(corrected_fit)) return {};
  return {{reason}, {}, corrected_fit, search.own, correction};
}

}  // namespace

Vec2d share_in_windows(DisplacementField const& all, Truth const& truth, double window_px) {
  constexpr int nodes = 8;  // number of nodes along one side of a window
  DisplacementField const ours = sample(all, 500);
  Vec2d product{}, square{};
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    Vec2d mean{};
    int count = 0;
    for (int node = 0; node < nodes * nodes; ++node) {
      int const column = node % nodes, row = node / nodes;
      Vec2d const of_window{(column + 0.5) / nodes - 0.5, (row + 0.5) / nodes - 0.5};
      Vec2d const t = truth(ours.position_px[i] + window_px * of_window);
      if (!is_finite(t)) continue;
      mean += t;
      ++count;
    }
    Vec2d const t = truth(ours.position_px[i]);
    if (count == 0 || !is_finite(t)) continue;
    product += Vec2d{mean.x * t.x, mean.y * t.y} / static_cast<double>(count);
    square += Vec2d{t.x * t.x, t.y * t.y};
  }
  auto const share = [](double p, double s) { return s > 0.0 ? std::clamp(p / s, 0.0, 1.0) : 0.0; };
  return {share(product.x, square.x), share(product.y, square.y)};
}

bool is_zero(DisplacementField const& field) {
  return std::all_of(field.displacement_px.begin(), field.displacement_px.end(),
                     [](Vec2d d) { return d == Vec2d{} || !is_finite(d); });
}

DisplacementField corrected(DisplacementField field, VectorCorrection const& correction) {
  for (Vec2d& d : field.displacement_px) {
    d -= correction.offset_px;
    d = {d.x / correction.factor.x, d.y / correction.factor.y};
  }
  for (Vec2d& p : field.position_px) p = p / correction.place_factor + correction.shift_px;
  return field;
}

ProbableMistake find_scale_or_shift(Search search, std::vector<ConventionFit> const& fits,
                                    std::vector<VectorConventions> const& own, bool any_reading) {
  ProbableMistake best;
  auto const consider = [&best](ProbableMistake found) {
    if (found.found() && (!best.found() || found.corrected_fit.spread_px < 0.9 * best.corrected_fit.spread_px))
      best = std::move(found);
  };
  consider(find_factor(search));
  consider(find_offset(search));
  // A shift of a few pixels changes a smooth field by more than this fraction of the signal.
  if (search.own.spread_px > 0.03 * search.own.signal_spread_px) {
    consider(find_shift(search));
    if (!best.found()) consider(find_place_factor(search));
  }
  if (best.found() || !any_reading) return best;
  ConventionFit const as_read = search.own;
  VectorConventions const first = search.own.conventions;
  double least_unlikely = std::numeric_limits<double>::infinity();
  for (ConventionFit const& fit : fits) {
    if (fit.conventions.offset_px != first.offset_px) continue;
    search.own = fit;
    ProbableMistake found = find_factor(search);
    double const unlikely = convention_penalty(fit.conventions, own);
    if (!found.found() || !(unlikely < least_unlikely)) continue;
    least_unlikely = unlikely;
    found.reasons.front().own = first;
    found.as_read = as_read;
    best = std::move(found);
  }
  return best;
}

}  // namespace gladstone::inline vectors
