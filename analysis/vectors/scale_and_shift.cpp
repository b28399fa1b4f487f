#include "analysis/vectors/scale_and_shift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace gladstone::detail {
namespace {

/// Returns the factor between a component and its truth by least absolute deviations: the median of their ratios,
/// weighted by |truth|. It is robust to up to half of the vectors being wrong.
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

/// Searches for displacements that are a multiple of the true ones.
ProbableMistake find_factor(Search const& search) {
  DisplacementField const ours = apply_conventions(search.few, search.own.conventions, search.image_rows);
  Vec2d const share = share_in_windows(ours, search.truth, 64.0);
  constexpr double least_followed = 0.05;  // minimum slope of windows that still measure a displacement
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
  // Use one factor for both components if the two agree.
  bool const both = std::abs(factor.x - factor.y) < 0.1 * std::max(factor.x, factor.y);
  if (both) factor.x = factor.y = 0.5 * (factor.x + factor.y);
  // Apply the factors to the columns of the file, which may be exchanged.
  VectorCorrection correction;
  correction.factor = search.own.conventions.exchanges_components() ? Vec2d{factor.y, factor.x} : factor;
  ConventionFit const corrected_fit = search.fit(search.few, correction);
  if (!search.is_improved(corrected_fit)) return {};
  std::string text;
  if (both)
    text = fmt::format("displacements are {:.3g} times the truth, as if in another unit than px", factor.x);
  else if (!determines(&Vec2d::y))
    text = fmt::format("u is {:.3g} times the truth (v is too small for an estimate)", factor.x);
  else if (!determines(&Vec2d::x))
    text = fmt::format("v is {:.3g} times the truth (u is too small for an estimate)", factor.y);
  else
    text = fmt::format("u is {:.3g} times and v {:.3g} times the truth", factor.x, factor.y);
  VectorConventions scaled = search.own.conventions;
  scaled.px_per_frame = std::stod(fmt::format("{:.3g}", scaled.px_per_frame.value_or(1.0) * factor.x));
  return {text, both ? describe(scaled) : std::string(), corrected_fit, search.own, correction};
}

/// Searches for a constant that all displacements have in addition.
ProbableMistake find_offset(Search const& search) {
  if (is_zero(search.few)) return {};  // in a uniform displacement an offset would explain it
  DisplacementField const ours = apply_conventions(search.few, search.own.conventions, search.image_rows);
  Vec2d offset{};
  for (auto const component : {&Vec2d::x, &Vec2d::y}) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      double const t = ours.counts(i) ? search.truth(ours.position_px[i]).*component : std::nan("");
      if (std::isfinite(t)) differences.push_back(ours.displacement_px[i].*component - t);
    }
    if (differences.empty()) return {};
    auto const middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    offset.*component = *middle;
  }
  constexpr double least = 0.2;  // greater than the bias by peak locking [px]
  if (!(std::max(std::abs(offset.x), std::abs(offset.y)) > least)) return {};
  auto const rounded = [](double value) { return 0.0 + std::round(1000.0 * value) / 1000.0; };
  std::string const text =
      fmt::format("displacements are ({:.4g}, {:.4g}) px greater than the truth", rounded(offset.x), rounded(offset.y));
  // Apply the offset to the columns of the file, whose signs and order may differ.
  VectorConventions const& c = search.own.conventions;
  if (c.swapped) offset = -offset;
  if (c.v_up) offset.y = -offset.y;
  VectorCorrection correction;
  correction.offset_px = c.exchanges_components() ? Vec2d{offset.y, offset.x} : offset;
  ConventionFit const corrected_fit = search.fit(search.few, correction);
  if (!search.is_improved(corrected_fit)) return {};
  return {text, {}, corrected_fit, search.own, correction};
}

VectorCorrection shift_by(Vec2d shift_px) {
  VectorCorrection correction;
  correction.shift_px = shift_px;
  return correction;
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double vague_px = 2.0;  ///< a component with a greater uncertainty is not determined [px]

/// Shift of the positions, and its uncertainty.
struct FittedShift {
  Vec2d shift_px{};
  Vec2d uncertainty_px{};  ///< three standard errors
};

/// Refines a shift by least squares: Newton's method on the mean square difference from the truth, whose derivatives
/// are finite differences. The standard errors assume that neighbouring windows overlap by half, as
/// log_likelihood_statistic().
FittedShift refine_shift(Search const& search, FittedShift fitted) {
  constexpr double h = 0.5, farthest = 1.0;  // step of the differences, and distance from the first estimate [px]
  double components = 1.0;
  auto const mean_square = [&](double dx, double dy) {
    ConventionFit const fit = search.fit(search.few, shift_by(fitted.shift_px + Vec2d{dx, dy}));
    components = static_cast<double>(std::max<std::size_t>(1, fit.components));
    return fit.spread_px * fit.spread_px;
  };
  Vec2d const first = fitted.shift_px;
  for (int iteration = 0; iteration < 4; ++iteration) {
    double const middle = mean_square(0, 0), right = mean_square(h, 0), left = mean_square(-h, 0),
                 below = mean_square(0, h), above = mean_square(0, -h);
    double const xx = (right - 2.0 * middle + left) / (h * h), yy = (below - 2.0 * middle + above) / (h * h);
    double const xy =
        (mean_square(h, h) - mean_square(h, -h) - mean_square(-h, h) + mean_square(-h, -h)) / (4.0 * h * h);
    double const gx = (right - left) / (2.0 * h), gy = (below - above) / (2.0 * h), determinant = xx * yy - xy * xy;
    // covariance 2 s^2 / n times the inverse Hessian, with a quarter of the components as independent
    double const variance = 8.0 * middle / components;
    auto const three_errors = [&](double curvature) { return 3.0 * std::sqrt(variance / std::max(curvature, 0.0)); };
    FittedShift next;
    if (xx > 0.0 && determinant > 0.0 && three_errors(determinant / std::max(xx, yy)) < vague_px) {
      next.shift_px = fitted.shift_px - Vec2d{(yy * gx - xy * gy) / determinant, (xx * gy - xy * gx) / determinant};
      next.uncertainty_px = {three_errors(determinant / yy), three_errors(determinant / xx)};
    } else if (xx > yy) {  // as in a shear, whose displacement is the same all along its layers
      next.shift_px = fitted.shift_px - Vec2d{gx / xx, 0.0};
      next.uncertainty_px = {three_errors(xx), infinity};
    } else {
      next.shift_px = fitted.shift_px - Vec2d{0.0, gy / yy};
      next.uncertainty_px = {infinity, three_errors(yy)};
    }
    if (!(length(next.shift_px - first) < farthest)) break;
    fitted = next;
  }
  return fitted;
}

/// Describes the shift of the positions that `fitted` undoes, as far as the displacement determines it.
std::string describe_shift(FittedShift const& fitted) {
  auto const digit = [](double uncertainty) { return uncertainty < 0.1 ? 0.01 : 0.1; };  // last digit [px]
  auto const rounded = [&](double value, double uncertainty) {
    return 0.0 - digit(uncertainty) * std::round(value / digit(uncertainty));
  };
  auto const along = [&](char axis, double value, double uncertainty, char other) {
    return fmt::format(
        "positions are shifted by {:.4g} px in {}, to within {:.2g} px (in {} this displacement does not determine a "
        "shift)",
        rounded(value, uncertainty), axis, std::max(digit(uncertainty), uncertainty), other);
  };
  auto const [shift, uncertainty] = fitted;
  if (!(uncertainty.y < vague_px) && uncertainty.x < vague_px) return along('x', shift.x, uncertainty.x, 'y');
  if (!(uncertainty.x < vague_px) && uncertainty.y < vague_px) return along('y', shift.y, uncertainty.y, 'x');
  double const larger = std::max(uncertainty.x, uncertainty.y);
  return fmt::format("positions are shifted by ({:.4g}, {:.4g}) px, each to within {:.2g} px", rounded(shift.x, larger),
                     rounded(shift.y, larger), std::max(digit(larger), larger));
}

/// Searches for positions with another origin: the shift that fits best, on a lattice of 4 px up to 64 px, refined by
/// least squares.
ProbableMistake find_shift(Search const& search) {
  constexpr double farthest = 64.0;
  DisplacementField const fewer = sample(search.few, 400);
  auto const fit = [&](Vec2d shift) { return search.fit(fewer, shift_by(shift)).spread_px; };
  Vec2d best{};
  double least = fit(best);
  auto const look_around = [&](Vec2d middle, double reach, double step) {
    for (double dy = -reach; dy <= reach; dy += step) {
      for (double dx = -reach; dx <= reach; dx += step) {
        double const rms = fit(middle + Vec2d{dx, dy});
        if (!(rms < least)) continue;
        least = rms;
        best = middle + Vec2d{dx, dy};
      }
    }
  };
  look_around({}, farthest, 4.0);
  constexpr double finest = 0.25;
  for (double const step : {2.0, 1.0, 0.5, finest}) look_around(best, step, step);
  // Set a component to 0 if this displacement does not determine it.
  for (auto const component : {&Vec2d::x, &Vec2d::y}) {
    Vec2d other = best;
    other.*component = 0.0;
    if (log_likelihood_statistic(search.fit(fewer, shift_by(best)), search.fit(fewer, shift_by(other))) < 9.0)
      best = other;
  }
  constexpr double counting = 2.0;  // conventions of pixel counting differ by less
  if (!(std::max(std::abs(best.x), std::abs(best.y)) > counting)) return {};
  FittedShift const fitted = refine_shift(search, {best, {finest, finest}});
  ConventionFit const corrected_fit = search.fit(search.few, shift_by(fitted.shift_px));
  if (!search.is_improved(corrected_fit)) return {};
  return {describe_shift(fitted), {}, corrected_fit, search.own, shift_by(fitted.shift_px)};
}

/// Searches for positions that are a multiple of the true ones.
ProbableMistake find_place_factor(Search const& search) {
  auto const scaled = [](double factor) {
    VectorCorrection correction;
    correction.place_factor = factor;
    return correction;
  };
  DisplacementField const fewer = sample(search.few, 400);
  double best = 1.0, least = std::numeric_limits<double>::infinity();
  auto const look_around = [&](double middle, double reach, double step) {
    for (double e = -reach; e <= reach; e += step) {
      double const factor = middle * std::exp(e), spread = search.fit(fewer, scaled(factor)).spread_px;
      if (!(spread < least)) continue;
      least = spread;
      best = factor;
    }
  };
  look_around(1.0, 1.4, 0.01);  // from a quarter to four times
  look_around(best, 0.01, 0.001);
  if (std::abs(best - 1.0) < 0.01) return {};
  ConventionFit const corrected_fit = search.fit(search.few, scaled(best));
  if (!search.is_improved(corrected_fit)) return {};
  VectorConventions words = search.own.conventions;
  words.px = std::stod(fmt::format("{:.3g}", words.px.value_or(1.0) * best));
  return {fmt::format("positions are {:.3g} times the true ones, as if in another unit than px", best), describe(words),
          corrected_fit, search.own, scaled(best)};
}

}  // namespace

Vec2d share_in_windows(DisplacementField const& all, Truth const& truth, double window_px) {
  constexpr int nodes = 8;  // along one side of a window
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
    found.text = describe_difference(fit.conventions, first) + " and " + found.text;
    found.as_read = as_read;
    best = std::move(found);
  }
  return best;
}

}  // namespace gladstone::detail
