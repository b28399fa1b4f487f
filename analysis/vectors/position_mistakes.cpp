#include "analysis/vectors/position_mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "analysis/vectors/convention_fit.h"

namespace gladstone::inline vectors {
namespace {

VectorCorrection shift_by(Vec2d shift_px) {
  VectorCorrection correction;
  correction.shift_px = shift_px;
  return correction;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Shift of the positions, and its uncertainty.
struct FittedShift {
  Vec2d shift_px{};
  Vec2d uncertainty_px{};  ///< uncertainty of the shift, three standard errors [px]
};

/// Refines a shift by least squares: Newton's method on the mean square difference from the truth, whose derivatives
/// are finite differences. The standard errors assume that neighbouring windows overlap by half, as
/// log_likelihood_statistic().
FittedShift refine_shift(Search const& search, FittedShift fitted) {
  // step of the finite differences, and largest distance of the refined shift from the first estimate [px]
  constexpr double h = 0.5, farthest = 1.0;
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
    // The covariance is 2 s^2 / n times the inverse Hessian; a quarter of the components is assumed to be independent.
    double const variance = 8.0 * middle / components;
    auto const three_errors = [&](double curvature) { return 3.0 * std::sqrt(variance / std::max(curvature, 0.0)); };
    FittedShift next;
    if (xx > 0.0 && determinant > 0.0 && three_errors(determinant / std::max(xx, yy)) < max_shift_uncertainty_px) {
      next.shift_px = fitted.shift_px - Vec2d{(yy * gx - xy * gy) / determinant, (xx * gy - xy * gx) / determinant};
      next.uncertainty_px = {three_errors(determinant / yy), three_errors(determinant / xx)};
    } else if (xx > yy) {  // only x is determined, for example in a shear flow whose displacement does not vary along y
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

}  // namespace

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
  constexpr double counting = 2.0;  // larger than the shifts between conventions of pixel counting [px]
  if (!(std::max(std::abs(best.x), std::abs(best.y)) > counting)) return {};
  FittedShift const fitted = refine_shift(search, {best, {finest, finest}});
  ConventionFit const corrected_fit = search.fit(search.few, shift_by(fitted.shift_px));
  if (!search.is_improved(corrected_fit)) return {};
  VectorConventions const& own = search.own.conventions;
  MistakeReason const reason{MistakeReason::Kind::shift, own, own, -fitted.shift_px, fitted.uncertainty_px};
  return {{reason}, {}, corrected_fit, search.own, shift_by(fitted.shift_px)};
}

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
  look_around(1.0, 1.4, 0.01);  // searches for factors from one quarter to four
  look_around(best, 0.01, 0.001);
  if (std::abs(best - 1.0) < 0.01) return {};
  ConventionFit const corrected_fit = search.fit(search.few, scaled(best));
  if (!search.is_improved(corrected_fit)) return {};
  VectorConventions words = search.own.conventions;
  words.px = std::stod(fmt::format("{:.3g}", words.px.value_or(1.0) * best));
  VectorConventions const& own = search.own.conventions;
  MistakeReason const reason{MistakeReason::Kind::position_factor, own, own, {best, best}};
  return {{reason}, describe(words), corrected_fit, search.own, scaled(best)};
}

}  // namespace gladstone::inline vectors
