#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/errors/error_summary.h"

namespace gladstone {

/// How well estimated uncertainties tell the errors, both components pooled. Gross errors, which no standard
/// uncertainty is about, are left out and counted, whether or not they have an uncertainty; so are other vectors
/// without one. NaN where nothing is left.
struct UncertaintyQuality {
  std::size_t count = 0;          ///< components that count
  std::size_t gross = 0;          ///< vectors left out for an error above gross_error_px
  std::size_t without_sigma = 0;  ///< other vectors left out, since sigma is NaN
  double coverage_1;              ///< part of the errors within sigma: 0.68 of normally distributed ones
  double coverage_2;              ///< within twice sigma: 0.95
  double rms_ratio;               ///< rms(sigma)/rms(error): 1 where sigma is right on the whole
  double correlation;             ///< of sigma with |error|: whether it tells good vectors from bad ones
  double sharpness_px;            ///< rms(sigma): of two methods that cover alike, the one that says less is the better
};

/// @param measured, truth, sigma of equal length [px]
/// @param mask of the same length, or empty: every vector counts
UncertaintyQuality uncertainty_quality(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                       std::span<Vec2d const> sigma, VectorMask const& mask);

/// Components of similar sigma, and what their errors come to.
struct UncertaintyBin {
  std::size_t count = 0;
  double rms_sigma_px, rms_error_px;
};

/// Bins of equal count in the order of sigma: where sigma tells the errors, rms(error) follows rms(sigma) from bin to
/// bin. The same components as in uncertainty_quality(); fewer bins where each would hold less than 50, none of
/// nothing.
std::vector<UncertaintyBin> uncertainty_bins(std::span<Vec2d const> measured, std::span<Vec2d const> truth,
                                             std::span<Vec2d const> sigma, VectorMask const& mask,
                                             std::size_t bins = 10);

/// The numbers of a quality by their names in errors.json.
std::vector<std::pair<std::string_view, double>> quality_measures(UncertaintyQuality const& quality);

}  // namespace gladstone
