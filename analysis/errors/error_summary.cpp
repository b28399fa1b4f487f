#include "analysis/errors/error_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone {
namespace {

/// Errors of the counted vectors, and the number of all vectors.
struct Errors {
  std::vector<Vec2d> error_px;
  std::size_t total = 0;
};

double mean(Errors const& errors, double Vec2d::*component) {
  if (errors.error_px.empty()) return not_a_number;
  double sum = 0.0;
  for (Vec2d const& e : errors.error_px) sum += e.*component;
  return sum / static_cast<double>(errors.error_px.size());
}

double deviation(Errors const& errors, double Vec2d::*component) {
  double const centre = mean(errors, component);
  double sum = 0.0;
  for (Vec2d const& e : errors.error_px) sum += (e.*component - centre) * (e.*component - centre);
  return std::sqrt(sum / static_cast<double>(errors.error_px.size()));  // 0/0 is NaN for no vectors
}

double rms(Errors const& errors, double largest) {
  double sum = 0.0;
  std::size_t count = 0;
  for (Vec2d const& e : errors.error_px) {
    if (length(e) > largest) continue;
    sum += dot(e, e);
    ++count;
  }
  return count == 0 ? not_a_number : std::sqrt(0.5 * sum / static_cast<double>(count));
}

double percentile_95(Errors const& errors) {
  std::vector<double> magnitude(errors.error_px.size());
  std::transform(errors.error_px.begin(), errors.error_px.end(), magnitude.begin(), [](Vec2d e) { return length(e); });
  return quantile(std::move(magnitude), 0.95);
}

double gross_fraction(Errors const& errors) {
  if (errors.error_px.empty()) return not_a_number;
  auto const gross =
      std::count_if(errors.error_px.begin(), errors.error_px.end(), [](Vec2d e) { return length(e) > gross_error_px; });
  return static_cast<double>(gross) / static_cast<double>(errors.error_px.size());
}

double valid_fraction(Errors const& errors) {
  return errors.total == 0 ? not_a_number
                           : static_cast<double>(errors.error_px.size()) / static_cast<double>(errors.total);
}

/// Error measure with its name in errors.json, study.csv and the reports. A new measure requires one more row below.
struct Measure {
  std::string_view name;
  double (*of)(Errors const&);
};
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array<Measure, 10> measures{{
    {"count", [](Errors const& e) { return static_cast<double>(e.error_px.size()); }},
    {"valid_fraction", valid_fraction},
    {"bias_u_px", [](Errors const& e) { return mean(e, &Vec2d::x); }},
    {"bias_v_px", [](Errors const& e) { return mean(e, &Vec2d::y); }},
    {"random_u_px", [](Errors const& e) { return deviation(e, &Vec2d::x); }},
    {"random_v_px", [](Errors const& e) { return deviation(e, &Vec2d::y); }},
    {"rms_px", [](Errors const& e) { return rms(e, infinity); }},
    {"rms_without_gross_px", [](Errors const& e) { return rms(e, gross_error_px); }},
    {"p95_px", percentile_95},
    {"gross_fraction", gross_fraction},
}};

Errors collect(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
               std::size_t total) {
  GLADSTONE_EXPECTS(measured.size() == truth.size());
  GLADSTONE_EXPECTS(mask.empty() || mask.size() == measured.size());
  Errors errors;
  errors.total = total == 0 ? measured.size() : total;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    Vec2d const error = measured[i] - truth[i];
    if (is_finite(error)) errors.error_px.push_back(error);
  }
  return errors;
}

}  // namespace

double quantile(std::vector<double> values, double fraction) {
  GLADSTONE_EXPECTS(fraction >= 0.0 && fraction <= 1.0);
  if (values.empty()) return not_a_number;
  double const rank = fraction * static_cast<double>(values.size() - 1);
  auto const below = static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), values.begin() + below, values.end());
  double const low = values[static_cast<std::size_t>(below)];
  if (static_cast<double>(below) == rank) return low;
  double const high = *std::min_element(values.begin() + below + 1, values.end());
  return low + (rank - static_cast<double>(below)) * (high - low);
}

VectorMask common_mask(DisplacementField const& measured, std::span<std::span<Vec2d const> const> references) {
  VectorMask mask(measured.size());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask[i] = measured.counts(i) && is_finite(measured.displacement_px[i]);
  }
  for (std::span<Vec2d const> const reference : references) {
    GLADSTONE_EXPECTS(reference.empty() || reference.size() == mask.size());
    for (std::size_t i = 0; i < reference.size(); ++i) mask[i] = mask[i] && is_finite(reference[i]);
  }
  return mask;
}

ErrorSummary summarize_errors(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                              std::size_t total) {
  Errors const errors = collect(measured, truth, mask, total);
  ErrorSummary summary;
  summary.count = errors.error_px.size();
  summary.valid_fraction = valid_fraction(errors);
  summary.bias_u_px = mean(errors, &Vec2d::x);
  summary.bias_v_px = mean(errors, &Vec2d::y);
  summary.random_u_px = deviation(errors, &Vec2d::x);
  summary.random_v_px = deviation(errors, &Vec2d::y);
  summary.rms_px = rms(errors, infinity);
  summary.rms_without_gross_px = rms(errors, gross_error_px);
  summary.p95_px = percentile_95(errors);
  summary.gross_fraction = gross_fraction(errors);
  return summary;
}

std::vector<std::pair<std::string_view, double>> error_measures(std::span<Vec2d const> measured,
                                                                std::span<Vec2d const> truth, VectorMask const& mask,
                                                                std::size_t total) {
  Errors const errors = collect(measured, truth, mask, total);
  std::vector<std::pair<std::string_view, double>> values;
  for (Measure const& measure : measures) values.emplace_back(measure.name, measure.of(errors));
  return values;
}

}  // namespace gladstone
