#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone::inline errors {

/// Selection of the vectors to which a comparison refers, one entry per vector: nonzero if the vector is counted. All
/// comparisons of a case use the same mask.
using VectorMask = std::vector<std::uint8_t>;

/// Selects the vectors with status valid or replaced for which the measurement and every reference are finite.
/// @param references  displacements at the same vectors, [measured.size()] each; empty ones are ignored
VectorMask common_mask(DisplacementField const& measured, std::span<std::span<Vec2d const> const> references);

/// Magnitude above which an error is a gross error, caused by a wrong correlation peak [px].
inline constexpr double gross_error_px = 1.0;

/// Errors of the counted vectors, measured minus true displacement [px], and the number of all vectors.
struct ErrorSample {
  std::vector<Vec2d> error_px;
  std::size_t total = 0;
};

/// Statistic of the error. A new one requires one more row in error_summary.cpp.
struct ErrorMeasure {
  std::string_view name;  ///< with its unit as suffix: key in errors.json, study.csv and benchmark.csv
  double (*compute)(ErrorSample const&);
  char const* heading = nullptr;  ///< column of the printed table; null: not in it
  bool of_case = true;            ///< true: error_measures() contains it
  bool of_benchmark = true;       ///< true: a BenchmarkScore contains it
};

/// Returns all error measures, in the order of their output:
/// - `count`: number of counted vectors
/// - `valid_fraction`: `count` divided by the number of all vectors of the measurement
/// - `gross`, `gross_fraction`: number and fraction of the counted vectors whose error exceeds gross_error_px in
/// magnitude
/// - `bias_u_px`, `bias_v_px`: mean error
/// - `random_u_px`, `random_v_px`: standard deviation of the error, normalised by N so that rms_px^2 is the mean of
///   bias^2 + random^2 over u and v
/// - `rms_px`: sqrt(mean(e_u^2 + e_v^2)/2); `rms_without_gross_px`: over the vectors without gross error
/// - `p95_px`: 95th percentile of the magnitude, interpolated linearly between order statistics
std::span<ErrorMeasure const> all_error_measures();

/// Values of all error measures. If no vector counts, the numbers of vectors are 0 and all other values except
/// `valid_fraction` are NaN (null in errors.json).
class ErrorSummary {
 public:
  /// Sets all values to 0.
  ErrorSummary();
  explicit ErrorSummary(ErrorSample const& sample);

  /// Return the value of a measure. @pre the name is that of an error measure
  double operator[](std::string_view name) const;
  double& operator[](std::string_view name);
  /// Returns the number of vectors that are counted or have gross errors. @param name  "count" or "gross"
  std::size_t count(std::string_view name = "count") const { return static_cast<std::size_t>((*this)[name]); }
  /// Returns the names and values of the selected measures.
  std::vector<std::pair<std::string_view, double>> values(bool ErrorMeasure::*selected) const;

 private:
  std::vector<double> values_;
};

/// Computes error statistics.
/// @param measured,truth  displacements, of equal length [px]
/// @param mask            vectors to count, of the same length; empty: all vectors
/// @param total           number of vectors to which valid_fraction refers; 0: measured.size()
ErrorSummary summarize_errors(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                              std::size_t total = 0);

/// Returns the error measures of errors.json and study.csv by name, in the order of the columns, starting with count.
std::vector<std::pair<std::string_view, double>> error_measures(std::span<Vec2d const> measured,
                                                                std::span<Vec2d const> truth, VectorMask const& mask,
                                                                std::size_t total = 0);

/// Returns a quantile, interpolated linearly between order statistics; fraction 0 is the smallest value, 1 the largest.
/// NaN for no values.
double quantile(std::vector<double> values, double fraction);

}  // namespace gladstone::inline errors
