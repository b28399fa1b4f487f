#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone {

/// Which vectors a comparison counts: nonzero where it does. One mask serves every comparison of a case.
using VectorMask = std::vector<std::uint8_t>;

/// The vectors of status valid or replaced whose measurement and whose every reference are finite.
/// @param references displacements at the same vectors, each of measured.size(); an empty one is absent and left out
VectorMask common_mask(DisplacementField const& measured,
                       std::initializer_list<std::span<Vec2d const>> references = {});
VectorMask common_mask(DisplacementField const& measured, std::span<std::span<Vec2d const> const> references);

/// Errors larger than this are gross: the correlation found a wrong peak [px].
inline constexpr double gross_error_px = 1.0;

/// Measured minus true displacement in numbers. Where no vector counts, `count` is 0 and all but the counts are NaN
/// (null in errors.json).
struct ErrorSummary {
  std::size_t count = 0;            ///< vectors that count
  double valid_fraction;            ///< count over all vectors of the measurement [1]
  double bias_u_px, bias_v_px;      ///< mean error
  double random_u_px, random_v_px;  ///< standard deviation of the error (of the population, so that rms is exact)
  double rms_px;                    ///< sqrt(mean(e_u^2 + e_v^2)/2)
  double rms_without_gross_px;      ///< the same over the vectors without gross error
  double p95_px;                    ///< 95th percentile of the magnitude, linear between order statistics
  double gross_fraction;            ///< vectors with a magnitude over gross_error_px, over `count` [1]
};

/// @param measured,truth same length [px]
/// @param mask           same length, or empty: every vector counts
/// @param total          what valid_fraction refers to; 0: the length
ErrorSummary summarize_errors(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                              std::size_t total = 0);

/// Every error measure by its name in errors.json and study.csv, in their order, count first.
std::vector<std::pair<std::string_view, double>> error_measures(std::span<Vec2d const> measured,
                                                                std::span<Vec2d const> truth, VectorMask const& mask,
                                                                std::size_t total = 0);

/// Names of the measures alone, in the same order: the columns of a study.
std::vector<std::string_view> error_measure_names();

/// Linear between order statistics, fraction 0 the smallest and 1 the largest; NaN of nothing. Reorders its copy.
double quantile(std::vector<double> values, double fraction);

}  // namespace gladstone
