#include "analysis/uncertainty/uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/correlator.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/uncertainty/combination.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline uncertainty {
namespace {

struct NamedUncertainty {
  char const* name;
  UncertaintyMethod estimate;
  bool on_gpu = false;  ///< whether the CUDA correlator supports the method
};

/// Table of all uncertainty methods.
constexpr std::array uncertainties{
    NamedUncertainty{"correlation_statistics", correlation_statistics, true},
    NamedUncertainty{"image_matching", image_matching},
    NamedUncertainty{"peak_ratio", peak_ratio_uncertainty},
    NamedUncertainty{"moment_of_correlation", moment_of_correlation},
    NamedUncertainty{"combination", combined_uncertainty},
};

/// Deforms both frames by the measured displacement field, whose gaps are filled first.
ImagePair matched_frames(DisplacementField const& field, InterrogationGrid const& grid, StoredFrames const& frames,
                         CorrelationSchedule const& schedule) {
  std::vector<GridVector> vectors(field.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    vectors[i].displacement = field.displacement_px[i];
    vectors[i].status = field.counts(i) ? VectorStatus::valid : VectorStatus::invalid;
  }
  std::vector<Vec2d> const nodes = smoothed_displacement(filled_displacement(vectors, grid.columns), grid.columns,
                                                         schedule.smoothing(schedule.passes() - 1));
  Image<double> const& reference = frames.reference();
  DensePredictor const predictor(grid, nodes, reference.columns(), reference.rows());
  return PairDeformer(reference, frames.flow(), schedule.spline_degree()).deform(predictor);
}

/// Returns why uncertainty = "auto" selects no method.
std::string explain_no_uncertainty(CorrelationSettings const& settings, CorrelatedFrames frames) {
  switch (frames) {
    case CorrelatedFrames::pair_on_gpu:
      return "on a GPU";
    case CorrelatedFrames::sequence:
      return "sequence";
    case CorrelatedFrames::ensemble:
      return "ensemble";
    case CorrelatedFrames::pair_on_cpu:
      break;
  }
  bool const matched = settings.window_px.size() > 1 || settings.final_passes > 1;
  return matched ? fmt::format("correlate.method = \"{}\"", settings.method) : "correlate.window_px has a single pass";
}

}  // namespace

std::vector<Vec2d> combined_uncertainty(UncertaintyInput const& input) {
  UncertaintyCombination const& combination = shipped_combination();
  std::vector<std::vector<Vec2d>> sigmas(combination.terms.size());
  for (std::size_t k = 0; k < sigmas.size(); ++k)
    for (NamedUncertainty const& row : uncertainties)
      if (combination.terms[k].method == row.name && combination.terms[k].weight != 0.0)
        sigmas[k] = row.estimate(input);
  std::vector<Vec2d> result(input.field.size());
  std::vector<double> logarithms(sigmas.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
      for (std::size_t k = 0; k < sigmas.size(); ++k)
        if (!sigmas[k].empty()) logarithms[k] = std::log(sigmas[k][i].*axis);
      result[i].*axis = std::exp(combination.log_sigma(logarithms));
    }
  return result;
}

std::string uncertainty_caveat(CorrelationSettings const& settings) {
  if (!settings.estimates_uncertainty()) return "";
  std::string const method = "uncertainty by " + settings.uncertainty + " is too small ";
  CorrelationMethod const& correlation = correlation_method(settings.method);
  if (correlation.by_phase) {
    return method + "for correlate.method = \"" + settings.method +
           "\", whose phase weighting amplifies noise (docs/estimators.md); use \"scc\" if the uncertainty is required";
  }
  if (correlation.optical_flow) {
    return method + "for correlate.method = \"" + settings.method +
           "\", an optical flow, whose errors exceed the noise of a window (docs/estimators.md); use \"scc\" if the "
           "uncertainty is required";
  }
  bool const matched = settings.window_px.size() > 1 || settings.final_passes > 1;
  return matched
             ? ""
             : method + "for a single pass, in which windows cut dots apart (docs/estimators.md); use several passes";
}

std::vector<std::string> uncertainty_methods() {
  std::vector<std::string> names;
  for (NamedUncertainty const& row : uncertainties) names.emplace_back(row.name);
  return names;
}

bool uncertainty_on_gpu(std::string const& method) {
  for (NamedUncertainty const& row : uncertainties)
    if (method == row.name) return row.on_gpu;
  return true;
}

CorrelationSettings choose_uncertainty(CorrelationSettings settings, bool on_cpu) {
  if (settings.uncertainty != "auto") return settings;
  settings.uncertainty = "correlation_statistics";
  bool const estimated = !correlation_method(settings.method).tracks_dots && uncertainty_caveat(settings).empty();
  if (!on_cpu || !estimated) settings.uncertainty = "none";
  return settings;
}

void record_uncertainty(DisplacementField& field, CorrelationSettings const& given, CorrelatedFrames frames) {
  if (correlation_method(given.method).tracks_dots) {
    field.uncertainty_method = "dot_fit";
    field.uncertainty_key = fmt::format("correlate.method = \"{}\"", given.method);
    return;
  }
  field.uncertainty_key = fmt::format("correlate.uncertainty = \"{}\"", given.uncertainty);
  field.uncertainty_method = given.uncertainty;
  if (given.uncertainty != "auto") return;
  bool const pair_on_cpu = frames == CorrelatedFrames::pair_on_cpu;
  field.uncertainty_method = pair_on_cpu ? choose_uncertainty(given, true).uncertainty : "none";
  if (field.uncertainty_method == "none")
    field.uncertainty_key += fmt::format(" ({})", explain_no_uncertainty(given, frames));
}

void estimate_uncertainty(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings) {
  if (!settings.estimates_uncertainty() || correlation_method(settings.method).tracks_dots) return;
  InterrogationGrid const grid = final_grid(settings, frames.reference().columns(), frames.reference().rows());
  GLADSTONE_EXPECTS(grid.size() == field.size());
  ImagePair const matched = matched_frames(field, grid, frames, CorrelationSchedule(settings));
  for (NamedUncertainty const& row : uncertainties)
    if (settings.uncertainty == row.name) field.sigma_px = row.estimate({field, matched, grid, settings});
  GLADSTONE_EXPECTS(field.sigma_px.size() == field.size());
  for (std::size_t i = 0; i < field.size(); ++i)
    if (field.status[i] != VectorStatus::valid) field.sigma_px[i] = {not_a_number, not_a_number};
}

void complete_uncertainty(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings) {
  bool const left_out =
      std::find(field.reason.begin(), field.reason.end(), VectorReason::uncorrelated) != field.reason.end();
  if (field.sigma_px.empty() || left_out) estimate_uncertainty(field, frames, settings);
}

}  // namespace gladstone::inline uncertainty
