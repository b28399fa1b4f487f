#include "studies/benchmark/benchmark_score.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"

namespace gladstone::inline benchmarks {
namespace {

bool is_inside(Vec2d at, int columns, int rows) {
  return at.x >= benchmark_border_px && at.y >= benchmark_border_px && at.x <= columns - 1 - benchmark_border_px &&
         at.y <= rows - 1 - benchmark_border_px;
}

}  // namespace

VectorMask benchmark_mask(DisplacementField const& field, int columns, int rows) {
  VectorMask mask(field.size());
  for (std::size_t i = 0; i < field.size(); ++i)
    mask[i] = is_inside(field.position_px[i], columns, rows) && field.counts(i) &&
              std::isfinite(length(field.displacement_px[i]));
  return mask;
}

std::vector<Vec2d> truth_at_vectors(DisplacementField const& field, DisplacementAt const& truth) {
  std::vector<Vec2d> result;
  result.reserve(field.size());
  for (Vec2d const& at : field.position_px) result.push_back(truth(at));
  return result;
}

BenchmarkScore score_vectors(DisplacementField const& field, std::vector<Vec2d> const& truth, int columns, int rows) {
  GLADSTONE_EXPECTS(truth.size() == field.size());
  BenchmarkScore score;
  score.vectors = static_cast<std::size_t>(std::count_if(field.position_px.begin(), field.position_px.end(),
                                                         [&](Vec2d at) { return is_inside(at, columns, rows); }));
  VectorMask const mask = benchmark_mask(field, columns, rows);
  score.errors = summarize_errors(field.displacement_px, truth, mask, score.vectors);
  double product = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!mask[i]) continue;
    if (length(field.displacement_px[i] - truth[i]) > gross_error_px) continue;
    product += dot(field.displacement_px[i], truth[i]);
    signal += dot(truth[i], truth[i]);
  }
  score.gain = product / signal;  // 0/0 is NaN if no vector is counted
  return score;
}

BenchmarkScore score_case(std::string const& of_case, DisplacementField const& field, DisplacementAt const& truth,
                          int columns, int rows) {
  BenchmarkScore score = score_vectors(field, truth_at_vectors(field, truth), columns, rows);
  if (of_case == step_case) score.step_width_px = step_width_px(field, step_case_height_px, columns);
  return score;
}

double median_relative_error(DisplacementField const& field, std::vector<Vec2d> const& truth) {
  std::vector<double> errors, displacements;
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const error = field.counts(i) ? length(field.displacement_px[i] - truth[i]) : std::nan("");
    if (!std::isfinite(error)) continue;
    errors.push_back(error);
    displacements.push_back(length(truth[i]));
  }
  return quantile(errors, 0.5) / std::max(0.5, quantile(displacements, 0.5));
}

std::vector<std::pair<std::string_view, double>> score_measures(BenchmarkScore const& score) {
  std::vector<std::pair<std::string_view, double>> measures{{"vectors", static_cast<double>(score.vectors)}};
  auto const errors = score.errors.values(&ErrorMeasure::of_benchmark);
  measures.insert(measures.end(), errors.begin(), errors.end());
  measures.insert(measures.end(), {{"gain", score.gain}, {"step_width_px", score.step_width_px}});
  return measures;
}

}  // namespace gladstone::inline benchmarks
