#include "analysis/errors/error_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline errors {
namespace {

double mean(ErrorSample const& errors, double Vec2d::*component) {
  if (errors.error_px.empty()) return not_a_number;
  double sum = 0.0;
  for (Vec2d const& e : errors.error_px) sum += e.*component;
  return sum / static_cast<double>(errors.error_px.size());
}

double deviation(ErrorSample const& errors, double Vec2d::*component) {
  double const centre = mean(errors, component);
  double sum = 0.0;
  for (Vec2d const& e : errors.error_px) sum += (e.*component - centre) * (e.*component - centre);
  return std::sqrt(sum / static_cast<double>(errors.error_px.size()));  // NaN (0/0) if there are no vectors
}

double rms(ErrorSample const& errors, double largest) {
  double sum = 0.0;
  std::size_t count = 0;
  for (Vec2d const& e : errors.error_px) {
    if (length(e) > largest) continue;
    sum += dot(e, e);
    ++count;
  }
  return count == 0 ? not_a_number : std::sqrt(0.5 * sum / static_cast<double>(count));
}

double percentile_95(ErrorSample const& errors) {
  std::vector<double> magnitude(errors.error_px.size());
  std::transform(errors.error_px.begin(), errors.error_px.end(), magnitude.begin(), [](Vec2d e) { return length(e); });
  return quantile(std::move(magnitude), 0.95);
}

double count_gross(ErrorSample const& errors) {
  return static_cast<double>(std::count_if(errors.error_px.begin(), errors.error_px.end(),
                                           [](Vec2d e) { return length(e) > gross_error_px; }));
}

double gross_fraction(ErrorSample const& errors) {
  if (errors.error_px.empty()) return not_a_number;
  return count_gross(errors) / static_cast<double>(errors.error_px.size());
}

double valid_fraction(ErrorSample const& errors) {
  return errors.total == 0 ? not_a_number
                           : static_cast<double>(errors.error_px.size()) / static_cast<double>(errors.total);
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Table of all error measures.
constexpr std::array measures{
    ErrorMeasure{"count", [](ErrorSample const& e) { return static_cast<double>(e.error_px.size()); }},
    ErrorMeasure{"valid_fraction", valid_fraction},
    ErrorMeasure{.name = "gross", .compute = count_gross, .of_case = false},
    ErrorMeasure{"bias_u_px", [](ErrorSample const& e) { return mean(e, &Vec2d::x); }, "bias u"},
    ErrorMeasure{"bias_v_px", [](ErrorSample const& e) { return mean(e, &Vec2d::y); }, "bias v"},
    ErrorMeasure{.name = "random_u_px",
                 .compute = [](ErrorSample const& e) { return deviation(e, &Vec2d::x); },
                 .heading = "random u",
                 .of_benchmark = false},
    ErrorMeasure{.name = "random_v_px",
                 .compute = [](ErrorSample const& e) { return deviation(e, &Vec2d::y); },
                 .heading = "random v",
                 .of_benchmark = false},
    ErrorMeasure{"rms_px", [](ErrorSample const& e) { return rms(e, infinity); }, "rms"},
    ErrorMeasure{"rms_without_gross_px", [](ErrorSample const& e) { return rms(e, gross_error_px); }},
    ErrorMeasure{"p95_px", percentile_95, "p95"},
    ErrorMeasure{.name = "gross_fraction", .compute = gross_fraction, .heading = "gross", .of_benchmark = false},
};

/// Returns the row of a measure.
std::size_t find_measure(std::string_view name) {
  auto const found =
      std::find_if(measures.begin(), measures.end(), [name](ErrorMeasure const& row) { return row.name == name; });
  GLADSTONE_EXPECTS(found != measures.end());
  return static_cast<std::size_t>(found - measures.begin());
}

ErrorSample collect(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                    std::size_t total) {
  GLADSTONE_EXPECTS(measured.size() == truth.size());
  GLADSTONE_EXPECTS(mask.empty() || mask.size() == measured.size());
  ErrorSample errors;
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

std::span<ErrorMeasure const> all_error_measures() { return measures; }

ErrorSummary::ErrorSummary() : values_(measures.size()) {}

ErrorSummary::ErrorSummary(ErrorSample const& sample) {
  for (ErrorMeasure const& measure : measures) values_.push_back(measure.compute(sample));
}

double ErrorSummary::operator[](std::string_view name) const { return values_[find_measure(name)]; }
double& ErrorSummary::operator[](std::string_view name) { return values_[find_measure(name)]; }

std::vector<std::pair<std::string_view, double>> ErrorSummary::values(bool ErrorMeasure::*selected) const {
  std::vector<std::pair<std::string_view, double>> found;
  for (std::size_t i = 0; i < measures.size(); ++i)
    if (measures[i].*selected) found.emplace_back(measures[i].name, values_[i]);
  return found;
}

ErrorSummary summarize_errors(std::span<Vec2d const> measured, std::span<Vec2d const> truth, VectorMask const& mask,
                              std::size_t total) {
  return ErrorSummary(collect(measured, truth, mask, total));
}

std::vector<std::pair<std::string_view, double>> error_measures(std::span<Vec2d const> measured,
                                                                std::span<Vec2d const> truth, VectorMask const& mask,
                                                                std::size_t total) {
  return summarize_errors(measured, truth, mask, total).values(&ErrorMeasure::of_case);
}

}  // namespace gladstone::inline errors
