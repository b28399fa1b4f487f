#include "analysis/errors/uncertainty_quality.h"

#include <cmath>

#include "render/base/contracts.h"

namespace gladstone {

UncertaintyQuality uncertainty_quality(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                       std::span<Vec2d const> sigma, VectorMask const& mask) {
  GLADSTONE_EXPECTS(measured.size() == truth.size() && measured.size() == sigma.size());
  GLADSTONE_EXPECTS(mask.empty() || mask.size() == measured.size());
  UncertaintyQuality quality{};
  double n = 0.0, within_1 = 0.0, within_2 = 0.0, e = 0.0, s = 0.0, ee = 0.0, ss = 0.0, es = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Vec2d const difference = measured[i] - truth[i], sigmas = sigma[i];
    bool const counts = mask.empty() || mask[i] != 0;
    if (!counts || !std::isfinite(length(difference)) || !std::isfinite(length(sigmas))) continue;
    if (length(difference) > gross_error_px) {
      ++quality.gross;
      continue;
    }
    for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
      double const error = std::abs(difference.*axis), deviation = sigmas.*axis;
      n += 1.0;
      within_1 += error <= deviation;
      within_2 += error <= 2.0 * deviation;
      e += error;
      s += deviation;
      ee += error * error;
      ss += deviation * deviation;
      es += error * deviation;
    }
  }
  quality.count = static_cast<std::size_t>(n);
  quality.coverage_1 = within_1 / n;  // 0/0: NaN of nothing
  quality.coverage_2 = within_2 / n;
  quality.rms_ratio = std::sqrt(ss / ee);
  quality.correlation = (n * es - e * s) / std::sqrt((n * ee - e * e) * (n * ss - s * s));
  return quality;
}

std::vector<std::pair<std::string_view, double>> quality_measures(UncertaintyQuality const& quality) {
  return {{"count", static_cast<double>(quality.count)},
          {"gross", static_cast<double>(quality.gross)},
          {"coverage_1", quality.coverage_1},
          {"coverage_2", quality.coverage_2},
          {"rms_ratio", quality.rms_ratio},
          {"correlation", quality.correlation}};
}

}  // namespace gladstone
