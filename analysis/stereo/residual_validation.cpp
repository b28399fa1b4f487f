#include "analysis/stereo/residual_validation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/median.h"

namespace gladstone::inline stereo {
namespace {

constexpr double least_px = 0.1;

/// Estimates the standard deviation of the residuals from their median [px].
double estimate_residual_scale(StereoField const& field) {
  constexpr double median_of_normal = 0.6745;
  std::vector<double> residuals;
  for (auto const& node : field.nodes)
    if (node) residuals.push_back(node->residual_px);
  return upper_median(std::move(residuals)) / median_of_normal;
}

}  // namespace

StereoField reject_large_residuals(StereoField field, double limit) {
  GLADSTONE_EXPECTS(limit >= 0.0);
  if (limit == 0.0) return field;
  double const scale_px = estimate_residual_scale(field);
  for (auto& node : field.nodes) {
    if (!node || node->residual_px <= least_px) continue;
    double const ratio =
        std::isfinite(node->residual_ratio) ? node->residual_ratio : node->residual_px / std::max(scale_px, least_px);
    if (ratio > limit) node->status = VectorStatus::invalid;
  }
  return field;
}

std::size_t count_rejected(StereoField const& field) {
  return static_cast<std::size_t>(std::count_if(field.nodes.begin(), field.nodes.end(), [](auto const& node) {
    return node && node->status != VectorStatus::valid;
  }));
}

}  // namespace gladstone::inline stereo
