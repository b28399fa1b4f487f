#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "analysis/vectors/displacement_field.h"
#include "studies/benchmark/benchmark_cases.h"

namespace gladstone::inline benchmarks {

/// Width of the border in which vectors are ignored, since codes treat it differently [px].
inline constexpr double benchmark_border_px = 32.0;

/// Agreement of vectors with the true displacement of a case; NaN if benchmark_mask() selects no vector.
struct BenchmarkScore {
  std::size_t vectors = 0;  ///< number of vectors of the file outside of the border
  ErrorSummary errors;      ///< of the counted (valid or replaced) vectors; valid_fraction refers to `vectors`
  /// Regression slope of the vectors on the truth, sum m t / sum t^2 over the vectors without gross error [1].
  double gain = 0.0;
  /// Width of the response to a displacement step [px], see step_width_px(); NaN for all cases but step_case.
  double step_width_px = std::numeric_limits<double>::quiet_NaN();
};

/// Selects the vectors outside of the border that are valid or replaced and finite.
VectorMask benchmark_mask(DisplacementField const& field, int columns, int rows);

/// @param truth  displacement at every vector [px]
BenchmarkScore score_vectors(DisplacementField const& field, std::vector<Vec2d> const& truth, int columns, int rows);

/// Scores vectors on a case: score_vectors(), and for step_case the width of the response.
BenchmarkScore score_case(std::string const& of_case, DisplacementField const& field, DisplacementAt const& truth,
                          int columns, int rows);

/// Returns the median difference of the vectors of benchmark_mask() from the truth, relative to the median displacement
/// or, if that is less, half a pixel. NaN if the mask selects no vector.
double median_relative_error(DisplacementField const& field, std::vector<Vec2d> const& truth);

/// Returns the truth at the positions of the vectors.
std::vector<Vec2d> truth_at_vectors(DisplacementField const& field, DisplacementAt const& truth);

/// Returns the numbers of a score with their names in benchmark.json and benchmark.csv.
std::vector<std::pair<std::string_view, double>> score_measures(BenchmarkScore const& score);

}  // namespace gladstone::inline benchmarks
