#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/errors/error_summary.h"

namespace gladstone::inline errors {

/// Agreement of estimated uncertainties with actual errors, both components pooled. Vectors with gross errors, which a
/// standard uncertainty does not describe, are excluded, and their number is reported, whether or not they have an
/// uncertainty. Other vectors without uncertainty are also excluded, and their number is reported. All ratios are NaN
/// if no component remains.
struct UncertaintyQuality {
  std::size_t count = 0;          ///< number of counted components
  std::size_t gross = 0;          ///< vectors excluded because of an error above gross_error_px
  std::size_t without_sigma = 0;  ///< other vectors excluded because sigma is NaN
  double coverage_1;              ///< fraction of the errors within sigma: 0.68 for normally distributed errors
  double coverage_2;              ///< fraction of the errors within 2 sigma: 0.95 for normally distributed errors
  double rms_ratio;               ///< rms(sigma)/rms(error): 1 if sigma is correct on average
  /// Correlation coefficient of sigma and |error|: ability to distinguish accurate from inaccurate vectors.
  double correlation;
  /// Rms of sigma [px]: of two methods with equal coverage, the one with the smaller value is better.
  double sharpness_px;
};

/// Computes the quality of estimated uncertainties.
/// @param measured,truth,sigma displacements and uncertainties, of equal length [px]
/// @param mask vectors to count, of the same length; empty: all vectors
UncertaintyQuality uncertainty_quality(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                       std::span<Vec2d const> sigma, VectorMask const& mask);

/// Components of similar sigma and the rms of their errors.
struct UncertaintyBin {
  std::size_t count = 0;
  double rms_sigma_px, rms_error_px;
};

/// Divides the components of uncertainty_quality() into ten bins of equal count in ascending order of sigma. If sigma
/// predicts the errors, rms(error) follows rms(sigma) from bin to bin. The number of bins is reduced so that each holds
/// at least 50 components (one bin below 100 components). Without any component, the result is empty.
std::vector<UncertaintyBin> uncertainty_bins(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                             std::span<Vec2d const> sigma, VectorMask const& mask);

/// Returns the numbers of a quality with their names in errors.json.
std::vector<std::pair<std::string_view, double>> quality_measures(UncertaintyQuality const& quality);

}  // namespace gladstone::inline errors
