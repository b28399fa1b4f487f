#include "analysis/errors/uncertainty_quality.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"

namespace gladstone::inline errors {
namespace {

/// Numbers of excluded vectors.
struct LeftOut {
  std::size_t gross = 0;
  std::size_t without_sigma = 0;
};

/// Calls visit(|error|, sigma) for every counted component.
template <class Visit>
LeftOut visit_components(std::span<Vec2d const> measured, std::span<Vec2d const> truth, std::span<Vec2d const> sigma,
                         VectorMask const& mask, Visit const& visit) {
  GLADSTONE_EXPECTS(measured.size() == truth.size() && measured.size() == sigma.size());
  GLADSTONE_EXPECTS(mask.empty() || mask.size() == measured.size());
  LeftOut left_out;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Vec2d const difference = measured[i] - truth[i], sigmas = sigma[i];
    bool const counts = mask.empty() || mask[i] != 0;
    if (!counts || !std::isfinite(length(difference))) continue;
    if (length(difference) > gross_error_px) {
      ++left_out.gross;
      continue;
    }
    if (!std::isfinite(length(sigmas))) {
      ++left_out.without_sigma;
      continue;
    }
    for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) visit(std::abs(difference.*axis), sigmas.*axis);
  }
  return left_out;
}

}  // namespace

UncertaintyQuality uncertainty_quality(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                       std::span<Vec2d const> sigma, VectorMask const& mask) {
  UncertaintyQuality quality{};
  double n = 0.0, within_1 = 0.0, within_2 = 0.0, e = 0.0, s = 0.0, ee = 0.0, ss = 0.0, es = 0.0;
  LeftOut const left_out = visit_components(measured, truth, sigma, mask, [&](double error, double deviation) {
    n += 1.0;
    within_1 += error <= deviation;
    within_2 += error <= 2.0 * deviation;
    e += error;
    s += deviation;
    ee += error * error;
    ss += deviation * deviation;
    es += error * deviation;
  });
  quality.count = static_cast<std::size_t>(n);
  quality.gross = left_out.gross;
  quality.without_sigma = left_out.without_sigma;
  quality.coverage_1 = within_1 / n;  // NaN (0/0) if there are no components
  quality.coverage_2 = within_2 / n;
  quality.rms_ratio = std::sqrt(ss / ee);
  quality.correlation = (n * es - e * s) / std::sqrt((n * ee - e * e) * (n * ss - s * s));
  quality.sharpness_px = std::sqrt(ss / n);
  return quality;
}

std::vector<UncertaintyBin> uncertainty_bins(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                             std::span<Vec2d const> sigma, VectorMask const& mask) {
  constexpr std::size_t bins = 10, fewest = 50;
  std::vector<std::pair<double, double>> pairs;  // sigma, error
  visit_components(measured, truth, sigma, mask,
                   [&](double error, double deviation) { pairs.emplace_back(deviation, error); });
  std::sort(pairs.begin(), pairs.end());
  std::size_t const used = pairs.empty() ? 0 : std::max<std::size_t>(1, std::min(bins, pairs.size() / fewest));
  std::vector<UncertaintyBin> result;
  for (std::size_t bin = 0; bin < used; ++bin) {
    std::size_t const begin = bin * pairs.size() / used, end = (bin + 1) * pairs.size() / used;
    double ss = 0.0, ee = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      ss += pairs[k].first * pairs[k].first;
      ee += pairs[k].second * pairs[k].second;
    }
    double const count = static_cast<double>(end - begin);
    result.push_back({end - begin, std::sqrt(ss / count), std::sqrt(ee / count)});
  }
  return result;
}

std::vector<std::pair<std::string_view, double>> quality_measures(UncertaintyQuality const& quality) {
  return {{"count", static_cast<double>(quality.count)},
          {"gross", static_cast<double>(quality.gross)},
          {"without_sigma", static_cast<double>(quality.without_sigma)},
          {"coverage_1", quality.coverage_1},
          {"coverage_2", quality.coverage_2},
          {"rms_ratio", quality.rms_ratio},
          {"correlation", quality.correlation},
          {"sharpness_px", quality.sharpness_px}};
}

}  // namespace gladstone::inline errors
