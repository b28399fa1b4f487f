#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone {

/// Selection of the vectors to which a comparison refers, one entry per vector: nonzero if the vector is counted. All
/// comparisons of a case use the same mask.
using VectorMask = std::vector<std::uint8_t>;

/// Selects the vectors with status valid or replaced for which the measurement and every reference are finite.
/// @param references  displacements at the same vectors, [measured.size()] each; empty ones are ignored
VectorMask common_mask(DisplacementField const& measured, std::span<std::span<Vec2d const> const> references);

/// Magnitude above which an error is a gross error, caused by a wrong correlation peak [px].
inline constexpr double gross_error_px = 1.0;

/// Statistics of the error, measured minus true displacement. If no vector is counted, `count` is 0 and all other
/// numbers except `valid_fraction` are NaN (null in errors.json).
struct ErrorSummary {
  std::size_t count = 0;        ///< number of counted vectors
  double valid_fraction;        ///< `count` divided by the number of all vectors of the measurement [1]
  double bias_u_px, bias_v_px;  ///< mean error of each component
  /// Standard deviation of the error, normalised by N so that rms_px^2 is the mean of bias^2 + random^2 over u and v.
  double random_u_px, random_v_px;
  double rms_px;                ///< root mean square error per component, sqrt(mean(e_u^2 + e_v^2)/2)
  double rms_without_gross_px;  ///< rms_px over the vectors without gross error
  /// 95th percentile of the error magnitude, interpolated linearly between order statistics.
  double p95_px;
  /// Fraction of the counted vectors whose error exceeds gross_error_px in magnitude [1].
  double gross_fraction;
};

/// Computes error statistics.
/// @param measured,truth  displacements, of equal length [px]
/// @param mask            vectors to count, of the same length; empty: all vectors
/// @param total           number of vectors to which valid_fraction refers; 0: measured.size()
ErrorSummary summarize_errors(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                              std::size_t total = 0);

/// Returns every error measure with its name in errors.json and study.csv, in the order of the columns, starting with
/// count.
std::vector<std::pair<std::string_view, double>> error_measures(std::span<Vec2d const> measured,
                                                                std::span<Vec2d const> truth, VectorMask const& mask,
                                                                std::size_t total = 0);

/// Returns a quantile, interpolated linearly between order statistics; fraction 0 is the smallest value, 1 the largest.
/// NaN for no values.
double quantile(std::vector<double> values, double fraction);

}  // namespace gladstone
