#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/compare/uncorrected_bias.h"
#include "studies/design/measurement_inputs.h"

namespace gladstone::inline design {
namespace {

/// Tolerance of derivatives d ln / d ln by formula and by ray tracing, for off-axis effects and finite differences.
constexpr double traced_tolerance = 0.02;

std::string degrees_text(double degrees) { return std::isfinite(degrees) ? fmt::format("{:.3g}", degrees) : "inf"; }

/// Returns true if formula and ray tracing agree on the derivative of the gradient. Also true if the derivative was not
/// traced or the gradient is 0.
bool same(MeasurementInput const& input, PropagatedResult const& gradient, Contribution const& contribution) {
  if (!input.traced || gradient.value == 0) return true;
  double const scale = input.value != 0 ? std::abs(input.value) : input.sigma;
  return std::abs(-*input.traced - contribution.derivative / gradient.value) * scale <= traced_tolerance;
}

/// Formats a moment; "undefined" if the distribution does not have it.
std::string sampled_text(std::optional<double> value, int digits) {
  return value ? fmt::format("{:.{}g}", *value, digits) : "undefined";
}

}  // namespace

std::vector<std::string> correlation_texts(std::vector<MeasurementInput> const& inputs) {
  std::vector<std::string> texts;
  for (MeasurementInput const& input : inputs) {
    for (InputCorrelation const& one : input.correlations) {
      if (input.key < one.with) texts.push_back(fmt::format("{} and {}, {:.3g}", input.key, one.with, one.coefficient));
    }
  }
  return texts;
}

std::string uncertainty_text(MeasurementUncertainty const& uncertainty) {
  std::string text =
      "uncertainty of a density gradient, and of the density step that it makes across one window (JCGM 100:2008; all "
      "inputs of type B)\n";
  text += fmt::format("  {:<30}{:>12}{:>11} {:<28}{:>9}{:>9}{:>13}{:>13}\n", "input", "value", "sigma", "drawn from",
                      "u(g)", "share", "dg/d(input)", "by rays");
  PropagatedResult const& gradient = uncertainty.results.front();
  for (std::size_t i = 0; i < uncertainty.inputs.size(); ++i) {
    MeasurementInput const& input = uncertainty.inputs[i];
    Contribution const& part = gradient.contributions[i];
    text +=
        fmt::format("  {:<30}{:>12.6g}{:>11.4g} {:<28}{:>9.2g}{:>7.1f} %{:>13.4g}{:>13}{}\n", input.key, input.value,
                    input.sigma, drawn_distribution(uncertainty.inputs, i), part.standard, 100 * part.share,
                    part.derivative, input.traced ? fmt::format("{:.4g}", -*input.traced * gradient.value) : "",
                    same(input, gradient, part) ? "" : "  formula and rays differ");
  }
  text += "  g: density gradient [kg/m^4]; inputs in the units of their keys\n";
  std::vector<std::string> const correlated = correlation_texts(uncertainty.inputs);
  for (std::string const& pair : correlated) text += "  correlated: " + pair + '\n';
  if (correlated.empty() && uncertainty.inputs.size() > 2)
    text += "  assumed to be independent ([[correlations]] has no entry)\n";
  for (PropagatedResult const& result : uncertainty.results) {
    text += fmt::format(
        "  {}: {:.6g}, combined standard uncertainty {:.3g}, effective degrees of freedom {}\n"
        "    expanded uncertainty {:.3g}, coverage factor {:.3f}, coverage probability 95.45 %\n"
        "    {} samples (JCGM 101:2008): mean {}, standard uncertainty {}, 95.45 % from {:.6g} to {:.6g}; {}\n",
        result.key, result.value, result.standard, degrees_text(result.degrees_of_freedom), result.expanded(),
        result.coverage_factor, propagation_samples, sampled_text(result.sampled_mean, 6),
        sampled_text(result.sampled_standard, 3), result.sampled_low, result.sampled_high,
        result.linear ? "first-order propagation is valid"
                      : "not linear, or not normal: use the interval of the samples");
  }
  text += fmt::format(
      "  not included: the uncorrected bias, {:.2g} % for a wave of twice the resolved wavelength:\n    {}\n",
      100 * (1 - uncertainty.share_resolved), describe_uncorrected_bias(bos_comparison));
  return text;
}

nlohmann::ordered_json uncertainty_json(MeasurementUncertainty const& uncertainty) {
  using Json = nlohmann::ordered_json;
  auto const finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  auto const known = [](std::optional<double> value) { return value ? Json(*value) : Json(nullptr); };
  Json json;
  json["inputs"] = Json::array();
  for (MeasurementInput const& input : uncertainty.inputs) {
    json["inputs"].push_back({{"key", input.key},
                              {"value", input.value},
                              {"sigma", input.sigma},
                              {"distribution", to_string(input.distribution)},
                              {"drawn_from", drawn_distribution(uncertainty.inputs, json["inputs"].size())},
                              {"degrees_of_freedom", finite(input.degrees_of_freedom)},
                              {"traced_log_derivative", input.traced ? Json(-*input.traced) : Json(nullptr)}});
  }
  json["correlations"] = Json::array();
  for (MeasurementInput const& input : uncertainty.inputs) {
    for (InputCorrelation const& one : input.correlations) {
      if (one.with < input.key) continue;
      json["correlations"].push_back({{"keys", {input.key, one.with}}, {"coefficient", one.coefficient}});
    }
  }
  json["results"] = Json::array();
  for (PropagatedResult const& result : uncertainty.results) {
    Json row{{"key", result.key},
             {"value", result.value},
             {"standard_uncertainty", result.standard},
             {"effective_degrees_of_freedom", finite(result.degrees_of_freedom)},
             {"coverage_factor", result.coverage_factor},
             {"expanded_uncertainty", result.expanded()},
             {"sampled_mean", known(result.sampled_mean)},
             {"sampled_standard_uncertainty", known(result.sampled_standard)},
             {"sampled_interval", {result.sampled_low, result.sampled_high}},
             {"linear", result.linear},
             {"contributions", Json::array()}};
    for (std::size_t i = 0; i < uncertainty.inputs.size(); ++i) {
      Contribution const& part = result.contributions[i];
      Json one{{"key", uncertainty.inputs[i].key},
               {"derivative", part.derivative},
               {"log_derivative", finite(part.derivative / result.value)},
               {"standard_uncertainty", part.standard},
               {"share", part.share}};
      if (&result == &uncertainty.results.front()) one["agrees_with_rays"] = same(uncertainty.inputs[i], result, part);
      row["contributions"].push_back(std::move(one));
    }
    json["results"].push_back(std::move(row));
  }
  json["uncorrected_bias"] = {{"is", describe_uncorrected_bias(bos_comparison)},
                              {"wave", "twice the resolved wavelength"},
                              {"share_lost", 1 - uncertainty.share_resolved}};
  return json;
}

}  // namespace gladstone::inline design
