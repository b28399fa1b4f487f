#include "analysis/tracking/overlap_resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/base/image.h"
#include "render/base/units.h"

namespace gladstone::inline tracking {
namespace {

constexpr double least_decrease = 25;   // smallest decrease of the sum of squares for which a dot is added
constexpr std::size_t most_splits = 3;  // number of dots for which a split is tried before a dot is added

DotFit plain_fit(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotModel const& model,
                 double most_cost = std::numeric_limits<double>::infinity()) {
  return fit_dots(pixels, start, model.shape, model.prior, most_cost);
}

/// Returns whether the residual of a fit may be more than noise.
/// @param cost  cost of the fit, or an upper bound of the cost; with a bound, only the result false is certain
bool has_significant_residual(double cost, int freedom) { return cost > freedom - std::sqrt(2.0 * freedom); }

/// Returns the pixels with the mismatch of the model added to their noise, in proportion to the largest level of the
/// pixel and its neighbours: at the edge of a dot, the level changes from pixel to pixel by more than its own value.
std::vector<FitPixel> with_mismatch(std::span<FitPixel const> pixels, DotFit const& fit, double mismatch) {
  PixelBox const box = bounding_box(pixels);
  // light of the dots, with a border of one pixel
  Image<double> light(box.right - box.left + 3, box.bottom - box.top + 3);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    light(pixels[i].column - box.left + 1, pixels[i].row - box.top + 1) =
        pixels[i].level - fit.residual[i] - fit.background;
  std::vector<FitPixel> changed(pixels.begin(), pixels.end());
  for (FitPixel& pixel : changed) {
    double most = 0;
    for (int row = pixel.row - box.top; row < pixel.row - box.top + 3; ++row)
      for (int column = pixel.column - box.left; column < pixel.column - box.left + 3; ++column)
        most = std::max(most, light(column, row));
    pixel.per_sigma = 1 / std::hypot(1 / pixel.per_sigma, mismatch * most);
  }
  return changed;
}

/// Returns the cost of a fit for a different noise of the pixels.
double cost_with(std::span<FitPixel const> pixels, DotFit const& fit) {
  double cost = fit.cost - fit.chi2;
  for (std::size_t i = 0; i < pixels.size(); ++i) cost += std::pow(fit.residual[i] * pixels[i].per_sigma, 2);
  return cost;
}

/// Returns the indices of the dots in the order of decreasing chi2 within two standard deviations of their centres.
std::vector<std::size_t> sort_by_residual(std::span<FitPixel const> pixels, DotFit const& fit) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < fit.dots.size(); ++k) {
    GaussianDot const& one = fit.dots[k];
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      Vec2d const at = Vec2d{1.0 * pixels[i].column, 1.0 * pixels[i].row} - one.centre;
      if (dot(at, at) < 2 * (one.xx + one.yy)) sum += std::pow(fit.residual[i] * pixels[i].per_sigma, 2);
    }
    order.emplace_back(-sum, k);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> indices;
  for (auto const& entry : order) indices.push_back(entry.second);
  return indices;
}

/// Replaces dot k by two dots, displaced along the axis of the largest second moment of its residual.
std::vector<GaussianDot> split_dot(std::span<FitPixel const> pixels, DotFit const& fit, std::size_t k) {
  GaussianDot const one = fit.dots[k];
  double const variance = 0.5 * (one.xx + one.yy);
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    Vec2d const at = Vec2d{1.0 * pixels[i].column, 1.0 * pixels[i].row} - one.centre;
    double const weight = fit.residual[i] * std::exp(-0.25 * dot(at, at) / variance);
    xx += weight * at.x * at.x;
    xy += weight * at.x * at.y;
    yy += weight * at.y * at.y;
  }
  double const angle = 0.5 * std::atan2(2 * xy, xx - yy);
  Vec2d const step = 0.6 * std::sqrt(variance) * Vec2d{std::cos(angle), std::sin(angle)};
  std::vector<GaussianDot> dots = fit.dots;
  dots[k].flux *= 0.5;
  dots.push_back(dots[k]);
  dots[k].centre = one.centre - step;
  dots.back().centre = one.centre + step;
  return dots;
}

/// Adds a dot at the position of the largest residual after filtering by the shape of the dots.
std::vector<GaussianDot> add_at_residual(std::span<FitPixel const> pixels, DotFit const& fit, DotModel const& model) {
  double const variance = model.prior.mean[0];
  GaussianDot added{{}, 0, variance, 0, variance};
  std::vector<double> shapes;  // value of the Gaussian at each squared distance [px^2]
  for (int r2 = 0; r2 <= 9 * variance + 1; ++r2) shapes.push_back(std::exp(-0.5 * r2 / variance));
  double most = 0;
  for (FitPixel const& centre : pixels) {
    double product = 0, square = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      int const x = pixels[i].column - centre.column, y = pixels[i].row - centre.row;
      auto const r2 = static_cast<std::size_t>(x * x + y * y);
      if (r2 >= shapes.size()) continue;
      double const shape = shapes[r2], weight = pixels[i].per_sigma * pixels[i].per_sigma;
      product += weight * shape * fit.residual[i];
      square += weight * shape * shape;
    }
    if (!(product / std::sqrt(square) > most)) continue;
    most = product / std::sqrt(square);
    added.centre = {1.0 * centre.column, 1.0 * centre.row};
    added.flux = 2 * pi * variance * product / square;
  }
  std::vector<GaussianDot> dots = fit.dots;
  if (most > 0) dots.push_back(added);
  return dots;
}

/// Returns whether the flux of every dot of a fit is significant, every centre lies within 1 px of a fitted pixel, and
/// no two centres are closer than can be separated.
bool plausible(std::span<FitPixel const> pixels, DotFit const& fit, DotModel const& model) {
  if (!std::isfinite(fit.cost)) return false;
  for (std::size_t k = 0; k < fit.dots.size(); ++k) {
    GaussianDot const& one = fit.dots[k];
    if (!(fit.dots[k].flux > model.detection_threshold * fit.flux_sigma[k])) return false;
    bool const inside = std::any_of(pixels.begin(), pixels.end(), [&](FitPixel const& pixel) {
      return std::abs(pixel.column - one.centre.x) <= 1 && std::abs(pixel.row - one.centre.y) <= 1;
    });
    if (!inside) return false;
    for (std::size_t m = 0; m < k; ++m)
      if (length(one.centre - fit.dots[m].centre) < closest_over_sigma * std::sqrt(one.xx)) return false;
  }
  return true;
}

}  // namespace

DotFit fit_overlapping_dots(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotModel const& model,
                            int most_additions) {
  DotFit const first = plain_fit(pixels, start, model);
  if (most_additions == 0 || !std::isfinite(first.cost)) return first;
  std::vector<FitPixel> const tolerant = with_mismatch(pixels, first, model.mismatch);
  // The cost of the fit with this noise does not exceed that of the first fit.
  if (!has_significant_residual(cost_with(tolerant, first), first.freedom)) return first;
  DotFit best = model.mismatch > 0 ? plain_fit(tolerant, first.dots, model) : first;
  if (!std::isfinite(best.cost)) return first;  // a fit that failed has no residuals
  int added = 0;
  for (; added < most_additions; ++added) {
    if (!has_significant_residual(best.cost, best.freedom)) break;
    DotFit better;
    better.cost = best.cost - least_decrease;
    bool found = false;
    std::vector<std::vector<GaussianDot>> trials{add_at_residual(tolerant, best, model)};
    std::vector<std::size_t> const worst = sort_by_residual(tolerant, best);
    for (std::size_t k = 0; k < std::min(most_splits, worst.size()); ++k)
      trials.push_back(split_dot(tolerant, best, worst[k]));
    for (std::vector<GaussianDot> const& dots : trials) {
      if (dots.size() == best.dots.size()) continue;
      DotFit fit = plain_fit(tolerant, dots, model, better.cost);
      if (!(fit.cost < better.cost) || !plausible(tolerant, fit, model)) continue;
      better = std::move(fit);
      found = true;
    }
    if (!found) break;
    best = std::move(better);
  }
  if (added == 0) return first;
  return model.mismatch > 0 ? plain_fit(pixels, best.dots, model) : best;
}

}  // namespace gladstone::inline tracking
