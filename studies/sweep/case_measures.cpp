#include "studies/sweep/case_measures.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "render/base/not_a_number.h"
#include "studies/case/case_warnings.h"
#include "studies/case/write_case.h"
#include "studies/compare/comparison_kind.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline sweep {
namespace {

void flatten(nlohmann::ordered_json const& json, std::string const& path,
             std::vector<std::pair<std::string, double>>& measures) {
  if (json.is_object()) {
    std::string const start = path.empty() ? "" : path + '.';
    for (auto const& [key, value] : json.items()) flatten(value, start + key, measures);
  } else if (json.is_number() || json.is_null()) {
    measures.emplace_back(path, json.is_null() ? not_a_number : json.get<double>());
  }
}

/// Returns the largest value of a map, at least 0, ignoring NaN.
double largest(Image<double> const& map) {
  double most = 0;
  for (double const value : map) most = std::max(most, std::isnan(value) ? 0 : value);
  return most;
}

double find_value(CaseResult const& result, std::string_view name) {
  for (auto const& [known, value] : result.measures) {
    if (known == name) return value;
  }
  return not_a_number;
}

}  // namespace

std::vector<std::pair<std::string, double>> flat_measures(nlohmann::ordered_json const& errors) {
  std::vector<std::pair<std::string, double>> measures;
  flatten(errors, "", measures);
  return measures;
}

void add_relative_errors(Setup const& setup, CaseResult& result) {
  double const error = find_value(result, comparison_kind(setup).references.front().measures + std::string(".rms_px"));
  double const signal = find_value(result, "signal_px");
  result.measures.emplace_back("error_over_signal", signal > 0 ? error / signal : not_a_number);
  bool const on_axis =
      setup.experiment().measures_density && !setup.pose && !setup.camera.tilted() && !setup.divides_light();
  double const sensitivity = on_axis ? make_projection_optics(setup).sensitivity() * setup.medium.thickness : 0;
  result.measures.emplace_back("gradient_error_kg_m4", sensitivity > 0 ? error / sensitivity : not_a_number);
}

void add_rendering(PreparedCase const& prepared, RenderedCase const& rendered, RecordedFrames const& frames,
                   CaseResult& result) {
  auto const add = [&result](char const* name, double value) { result.measures.emplace_back(name, value); };
  add("strain_max", prepared.strain.strain.empty() ? not_a_number : largest(prepared.strain.strain));
  add("magnification", prepared.scene.imaging.magnification);
  add("step_mm", prepared.plan.step_estimate.step_mm);
  add("rays_per_dot", static_cast<double>(prepared.plan.rays));
  add("exposure", rendered.exposure_e);
  add("dots", static_cast<double>(prepared.scene.source_count()));
  add("caustic_fraction", prepared.strain.caustic_fraction);
  add("saturated", static_cast<double>(frames.saturated_reference + frames.saturated_flow));
  result.warnings = prepared.warnings;
  warn_of_rendering(result.warnings, prepared, rendered, frames);
}

}  // namespace gladstone::inline sweep
