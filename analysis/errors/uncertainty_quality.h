#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/errors/error_summary.h"

namespace gladstone {

/// How well estimated uncertainties tell the errors, both components pooled. Gross errors, which no standard
/// uncertainty is about, are left out and counted; so are vectors without an uncertainty. NaN where nothing is left.
struct UncertaintyQuality {
  std::size_t count = 0;  ///< components that count
  std::size_t gross = 0;  ///< vectors left out for an error above gross_error_px
  double coverage_1;      ///< part of the errors within sigma: 0.68 of normally distributed ones
  double coverage_2;      ///< within twice sigma: 0.95
  double rms_ratio;       ///< rms(sigma)/rms(error): 1 where sigma is right on the whole
  double correlation;     ///< of sigma with |error|: whether it tells good vectors from bad ones
};

/// @param measured, truth, sigma of equal length [px]
/// @param mask of the same length, or empty: every vector counts
UncertaintyQuality uncertainty_quality(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                       std::span<Vec2d const> sigma, VectorMask const& mask);

/// The same numbers by their names in errors.json.
std::vector<std::pair<std::string_view, double>> quality_measures(UncertaintyQuality const& quality);

}  // namespace gladstone
