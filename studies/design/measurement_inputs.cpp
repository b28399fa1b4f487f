#include "studies/design/measurement_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/medium/gladstone_dale.h"
#include "render/render.h"
#include "render/setup/setup_node.h"
#include "studies/case/log_silencer.h"
#include "studies/compare/uncorrected_bias.h"
#include "studies/design/input_draws.h"

namespace gladstone::inline design {
namespace {

constexpr double step_share = 1e-3;      ///< step of the central difference, relative to the value
constexpr double traced_gradient = 1.0;  ///< uniform gradient through which rays are traced [kg/m^4]
constexpr int traced_px = 96;            ///< size of the central part of the image that is traced
/// rays per dot, which differ in their starting points only, since all pass through the centre of the pupil
constexpr int traced_rays = 16;
struct FormulaKey {
  char const* key;
  GradientInput input;
  double unit;
};
constexpr std::array<FormulaKey, 7> formula_keys{{
    {"camera.pixel_pitch_um", GradientInput::pixel_pitch, unit::micrometre},
    {"lens.focal_length_mm", GradientInput::focal_length, unit::millimetre},
    {"geometry.z_a_mm", GradientInput::z_a, unit::millimetre},
    {"geometry.z_d_mm", GradientInput::z_d, unit::millimetre},
    {"medium.gladstone_dale", GradientInput::gladstone_dale, 1},
    {"medium.thickness_mm", GradientInput::thickness, unit::millimetre},
    {"medium.ambient_density_kg_m3", GradientInput::ambient_density, 1},
}};

SetupNode steady_gradient() {
  SetupNode field;
  field.members.push_back({"kind", setup_text("uniform_gradient")});
  field.members.push_back(
      {"gradient_kg_m4", setup_array({setup_number(traced_gradient), setup_number(0), setup_number(0)})});
  return field;
}

/// Computes the mean displacement along the gradient over the dots of a setup, with a key set to a value [px].
double traced_displacement(CaseSetup const& loaded, UncertainInput const& input, double value, Renderer& renderer) {
  SetupDocument changed = loaded.document.unread();
  // remove the tables on which the displacement does not depend
  for (char const* const table : {"light", "correlate", "render"}) changed.remove({table});
  int const columns = std::min(loaded.setup.camera.columns, traced_px),
            rows = std::min(loaded.setup.camera.rows, traced_px);
  changed.set({"camera", "pixels"}, setup_array({setup_integer(columns), setup_integer(rows)}));
  changed.set({"correlate", "window_px"}, setup_array({setup_integer(std::min({columns, rows, 32}) / 2 * 2)}));
  changed.set({"medium", "field"}, steady_gradient());
  changed.set({"medium", "thickness_mm"}, setup_number(loaded.setup.medium.thickness / unit::millimetre));
  changed.set({"render", "rays_per_dot"}, setup_integer(traced_rays));
  changed.set({"lens", "f_number"}, setup_number(std::numeric_limits<double>::infinity()));
  changed.set(input.path, setup_number(value));
  CaseSetup moved = load_case_setup(std::move(changed));
  PreparedCase prepared = prepare_case(moved);
  GroundTruth const truth = render(prepared.scene, prepared.plan, renderer, RenderImages::no, RenderTheory::no).truth;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(truth.displacement_px[i].x)) continue;
    sum += truth.displacement_px[i].x;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : std::nan("");
}

MeasurementInput of_setup(UncertainInput const& input, CaseSetup const& loaded) {
  MeasurementInput one{
      input.key, input.value,        input.sigma, input.distribution, input.degrees_of_freedom, {}, 1, 1,
      {},        input.correlations, {}};
  bool const bench = loaded.setup.has_closed_form_layout();
  for (FormulaKey const& known : formula_keys) {
    if (input.key != known.key) continue;
    (bench ? one.enters : one.scales) = known.input;
    one.unit = known.unit;
  }
  if (!bench) return one;
  SetupNode const* const constant = loaded.document.find({"medium", "gladstone_dale"});
  std::optional<GasMixture> const& gas = loaded.setup.medium.gas;
  bool const by_wavelength = gas || (constant && constant->kind == SetupNode::Kind::text);
  if (input.key == "medium.wavelength_nm" && by_wavelength) {
    one.enters = GradientInput::gladstone_dale;
    one.unit = unit::nanometre;
    double const lambda = loaded.setup.medium.wavelength, step = 1e-4 * lambda;
    auto const k = [&](double at) {
      if (gas) return gas->gladstone_dale(at);
      return constant->text == "ciddor" ? gladstone_dale_ciddor(at) : gladstone_dale_merzkirch(at);
    };
    one.chain = (k(lambda + step) - k(lambda - step)) / (2 * step) * lambda / k(lambda);
  }
  return one;
}

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

std::optional<double> traced_log_derivative(CaseSetup const& loaded, UncertainInput const& input, Renderer& renderer) {
  if (input.key == "lens.f_number") return std::nullopt;  // the aperture does not affect the displacement of chief rays
  LogSilencer const quiet;
  double const step = input.value != 0 ? step_share * std::abs(input.value) : step_share * input.sigma;
  if (step == 0) return std::nullopt;
  auto const displacement_at = [&](double value) -> std::optional<double> {
    try {
      return traced_displacement(loaded, input, value, renderer);
    } catch (SetupError const&) {
      return std::nullopt;
    }
  };
  std::optional<double> more = displacement_at(input.value + step), less = displacement_at(input.value - step);
  double apart = 2 * step;
  // one-sided difference if the sign of the key is restricted
  if (input.value == 0 && more.has_value() != less.has_value()) {
    (more ? less : more) = displacement_at(0);
    apart = step;
  }
  // neither value is valid: a key of the replaced field or correlation, which has no effect here
  if (!more || !less) return std::nullopt;
  double const slope = std::log(*more / *less) / apart;
  return std::isfinite(slope) ? std::optional(slope) : std::nullopt;
}

GradientMeasurement<double> gradient_measurement(Setup const& setup, int window_px, double displacement_px) {
  GradientMeasurement<double> at;
  at.window_px = window_px;
  at.value = {displacement_px, setup.camera.pixel_pitch,    setup.lens.focal_length, setup.z_a,
              setup.z_d,       setup.medium.gladstone_dale, setup.medium.thickness,  setup.medium.ambient_density};
  return at;
}

std::vector<MeasurementInput> measurement_inputs(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                                 Renderer& renderer) {
  std::vector<MeasurementInput> inputs;
  for (UncertainInput const& input : uncertain) {
    inputs.push_back(of_setup(input, loaded));
    inputs.back().traced = traced_log_derivative(loaded, input, renderer);
  }
  return inputs;
}

MeasurementUncertainty measurement_uncertainty(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                               DesignPoint<double> const& bench, double gradient, Renderer& renderer) {
  MeasurementUncertainty told;
  told.random_px = bench.random_error();
  told.inputs.push_back({"displacement_px", bench.sensitivity() * gradient, told.random_px, InputDistribution::normal,
                         std::numeric_limits<double>::infinity(), GradientInput::displacement, 1, 1, std::nullopt});
  for (MeasurementInput& input : measurement_inputs(loaded, uncertain, renderer)) {
    told.traced = told.traced || input.traced;
    told.inputs.push_back(std::move(input));
  }
  told.results = propagate(
      gradient_measurement(loaded.setup, bench.given->window.window_px(), told.inputs.front().value), told.inputs);
  told.share_resolved = bench.transfer(2 * resolved_wavelength(bench));
  return told;
}

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
