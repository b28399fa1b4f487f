#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "render/base/displacement_field.h"
#include "studies/benchmark/benchmark_cases.h"

namespace gladstone {

/// Vectors closer to the border than this are left out: codes differ in what they do there [px].
inline constexpr double benchmark_border_px = 32.0;

/// How vectors compare with a case's truth at their places. NaN where nothing is left to judge by.
struct BenchmarkScore {
  std::size_t vectors = 0;  ///< in the file, away from the border
  ErrorSummary errors{};    ///< of those that count (valid or replaced); valid_fraction refers to `vectors`
  std::size_t gross = 0;    ///< errors above gross_error_px
  /// Share of the true displacement that the vectors follow: sum m t / sum t^2 over those without gross error.
  double gain = 0.0;
};

/// Which vectors are away from the border, and of those which count.
VectorMask benchmark_mask(DisplacementField const& field, int columns, int rows);

/// @param truth displacement at every vector [px]
BenchmarkScore score_vectors(DisplacementField const& field, std::vector<Vec2d> const& truth, int columns, int rows);

/// Truth at the vectors' places.
std::vector<Vec2d> truth_at_vectors(DisplacementField const& field, DisplacementAt const& truth);

/// The numbers of a score by their names in benchmark.json and benchmark.csv.
std::vector<std::pair<std::string_view, double>> score_measures(BenchmarkScore const& score);

}  // namespace gladstone
