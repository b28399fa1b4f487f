#include "studies/compare/comparison_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "analysis/errors/uncertainty_quality.h"
#include "analysis/vectors/convention_report.h"
#include "studies/case/json_text.h"
#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {
namespace {

nlohmann::json term_json(BudgetTerm const& term) {
  nlohmann::json json{{"bias_u_px", number_or_null(term.bias_u_px)},
                      {"bias_v_px", number_or_null(term.bias_v_px)},
                      {"random_u_px", number_or_null(term.random_u_px)},
                      {"random_v_px", number_or_null(term.random_v_px)},
                      {"rms_px", number_or_null(term.rms_px)}};
  if (!term.includes.empty()) json["includes"] = term.includes;
  return json;
}

nlohmann::json matrix_json(CovarianceMatrix const& matrix) {
  nlohmann::json rows = nlohmann::json::array();
  for (std::size_t i = 0; i < matrix.size; ++i) {
    nlohmann::json row = nlohmann::json::array();
    for (std::size_t j = 0; j < matrix.size; ++j) row.push_back(number_or_null(matrix(i, j)));
    rows.push_back(row);
  }
  return rows;
}

nlohmann::ordered_json fit_json(ConventionFit const& fit) {
  return {{"conventions", describe(fit.conventions)}, {"rms_px", number_or_null(fit.rms_px)}};
}

/// Returns how a foreign file's vectors fit the truth: with the detected conventions, without offset, and with every
/// other convention.
nlohmann::ordered_json fit_json(DetectedConventions const& detected) {
  using Verdict = DetectedConventions::Verdict;
  nlohmann::ordered_json json = fit_json(detected.fit);
  json["verdict"] = detected.verdict == Verdict::fits       ? "fits"
                    : detected.verdict == Verdict::noisy    ? "noisy"
                    : detected.verdict == Verdict::mistaken ? "mistaken"
                                                            : "cannot_be_told";
  ProbableMistake const& mistake = detected.mistake;
  json["likely_mistake"] = nullptr;
  if (mistake.found()) {
    json["likely_mistake"] = {{"text", describe_mistake(mistake)},
                              {"rms_without_px", number_or_null(mistake.corrected_fit.rms_px)}};
    if (!mistake.conventions.empty()) json["likely_mistake"]["conventions"] = mistake.conventions;
  }
  json["ambiguous"] = detected.ambiguous;
  json["signal_px"] = number_or_null(detected.fit.signal_px);
  json["slope"] = number_or_null(detected.fit.slope);
  json["offset_px"] = detected.conventions.offset_px;
  json["rms_without_offset_px"] = number_or_null(detected.without_offset.rms_px);
  json["tried"] = nlohmann::ordered_json::array();
  for (ConventionFit const& fit : detected.tried) json["tried"].push_back(fit_json(fit));
  return json;
}

/// Returns the quality of the measured uncertainties as predictions of the errors against the truth on the window, on
/// the deformed window, and at the point; the last also contains the averaging over the window. Empty if there are no
/// uncertainties.
nlohmann::ordered_json uncertainty_json(Comparison const& comparison) {
  DisplacementField const& measured = comparison.measured;
  if (std::none_of(measured.sigma_px.begin(), measured.sigma_px.end(), is_finite)) return {};
  nlohmann::ordered_json json;
  std::vector<Vec2d> const &window = comparison.window.displacement_px,
                           &deformed_window = comparison.deformed_window.displacement_px;
  for (auto const& [name, truth] :
       {std::pair("window_truth", &window), std::pair("deformed_window_truth", &deformed_window),
        std::pair("ray_truth", &comparison.point.displacement_px)}) {
    UncertaintyQuality const quality =
        uncertainty_quality(measured.displacement_px, *truth, measured.sigma_px, comparison.mask);
    for (auto const& [measure, value] : quality_measures(quality)) {
      bool const is_count = measure == "count" || measure == "gross" || measure == "without_sigma";
      json[name][std::string(measure)] =
          is_count ? nlohmann::json(static_cast<long long>(value)) : number_or_null(value);
    }
  }
  json["bins"] = nlohmann::ordered_json::array();
  for (UncertaintyBin const& bin : uncertainty_bins(measured.displacement_px, comparison.recorded().displacement_px,
                                                    measured.sigma_px, comparison.mask))
    json["bins"].push_back(
        {{"count", bin.count}, {"rms_sigma_px", bin.rms_sigma_px}, {"rms_error_px", bin.rms_error_px}});
  return json;
}

/// Formats the coverage of the errors by the vectors' uncertainties; empty without uncertainties.
std::string uncertainty_line(Comparison const& comparison) {
  DisplacementField const& measured = comparison.measured;
  if (measured.sigma_px.empty()) return "";
  UncertaintyQuality const quality = uncertainty_quality(
      measured.displacement_px, comparison.recorded().displacement_px, measured.sigma_px, comparison.mask);
  if (quality.count == 0) return "";
  return fmt::format(
      "  standard uncertainties: {:.1f} % of the errors against {} lie within one, {:.1f} % within two (normal "
      "distribution: 68.3 and 95.4 %); rms(sigma)/rms(error) {:.2f}\n",
      100 * quality.coverage_1, comparison.recorded_name(), 100 * quality.coverage_2, quality.rms_ratio);
}

/// Formats the terms `window` and `estimator` of an undeformed window; empty unless passes deform the frames.
std::string undeformed_line(Comparison const& comparison) {
  if (!comparison.frames_deformed) return "";
  auto const rms = [&comparison](char const* name) {
    for (BudgetTerm const& term : comparison.budget.terms) {
      if (term.name == name) return term.rms_px;
    }
    return std::nan("");
  };
  return fmt::format(
      "  window and estimator refer to frames deformed by the passes; for an undeformed window they are {:.5f}, {:.5f} "
      "px\n",
      rms("window"), rms("estimator"));
}

/// Formats the value of a measure in px, or of a fraction in per cent, as a column of the table.
std::string cell(ErrorMeasure const& measure, ErrorSummary const& summary) {
  double const value = summary[measure.name];
  return measure.name.ends_with("_fraction") ? fmt::format(" {:7.2f} %", 100 * value) : fmt::format(" {:9.5f}", value);
}

}  // namespace

nlohmann::ordered_json compute_error_measures(Comparison const& comparison) {
  nlohmann::ordered_json json;
  auto const summary = [&](std::vector<Vec2d> const& truth) {
    nlohmann::ordered_json measures;
    for (auto const& [name, value] :
         error_measures(comparison.measured.displacement_px, truth, comparison.mask, comparison.vectors_in_file())) {
      measures[std::string(name)] =
          name == "count" ? nlohmann::json(static_cast<long long>(value)) : number_or_null(value);
    }
    return measures;
  };
  json["ray_truth"] = summary(comparison.point.displacement_px);
  for (ReferenceDisplacement const& one : comparison_kind(comparison).references)
    json[one.measures] = summary(one.of(comparison));
  for (char const* const of_bos : {"eq9_cone", "eq9"})
    if (!json.contains(of_bos)) json[of_bos] = nullptr;
  json["window_truth"] = summary(comparison.window.displacement_px);
  if (nlohmann::ordered_json const quality = uncertainty_json(comparison); !quality.empty())
    json["uncertainty"] = quality;
  nlohmann::ordered_json budget;
  nlohmann::json names = nlohmann::json::array();
  for (BudgetTerm const& term : comparison.budget.terms) {
    budget["terms"][term.name] = term_json(term);
    names.push_back(term.name);
  }
  if (comparison.frames_deformed) {
    for (BudgetTerm const& term : comparison.budget_after_passes.terms) {
      if (term.name == "window" || term.name == "estimator")
        budget["after_passes"]["terms"][term.name] = term_json(term);
    }
  }
  budget["total"] = term_json(comparison.budget.total);
  budget["covariance"] = {{"terms", names},
                          {"both_px2", matrix_json(comparison.budget.covariance)},
                          {"u_px2", matrix_json(comparison.budget.covariance_u)},
                          {"v_px2", matrix_json(comparison.budget.covariance_v)}};
  budget["peak_locking_px"] = number_or_null(comparison.budget.peak_locking_px);
  budget["closure_px"] = number_or_null(comparison.budget.closure_px);
  json["budget"] = budget;
  json["vectors"] = {{"total", comparison.vectors_in_file()},
                     {"left_out_fewer_than_three_dots", comparison.window.left_out},
                     {"conventions", comparison.report}};
  RejectedVectors const& left_out = comparison.left_out;
  if (comparison.foreign || left_out.all() > 0) {  // vectors of the study itself: only if some are rejected
    json["vectors"].update({{"left_out_place_not_finite", left_out.place_not_finite},
                            {"left_out_outside_image", left_out.outside_image},
                            {"left_out_displacement_not_finite", left_out.displacement_not_finite},
                            {"left_out_displacement_beyond_image", left_out.displacement_beyond_image}});
  }
  if (comparison.detected) json["vectors"]["fit"] = fit_json(*comparison.detected);
  if (!comparison.sources.all().empty()) {
    nlohmann::ordered_json made_from;
    for (SourceFiles::Source const& source : comparison.sources.all()) {
      if (!source.name.empty()) made_from[source.name + "_sha256"] = source.sha256;
    }
    made_from["frames"] = comparison.verified ? "verified" : "unverified";
    json["made_from"] = made_from;
  }
  return json;
}

std::string errors_json(Comparison const& comparison) { return json_text(compute_error_measures(comparison)) + "\n"; }

std::string error_report(Comparison const& comparison) {
  struct Row {
    char const* name;
    std::vector<Vec2d> const& truth;
  };
  std::vector<Row> rows{{"ray truth", comparison.point.displacement_px}};
  ComparisonKind const& kind = comparison_kind(comparison);
  for (ReferenceDisplacement const& one : kind.references) rows.push_back({one.row, one.of(comparison)});
  rows.push_back({"ray truth on the window", comparison.window.displacement_px});
  std::string text = "Measurement against   [px] ";
  for (ErrorMeasure const& measure : all_error_measures())
    if (measure.heading) text += fmt::format(" {:>9}", measure.heading);
  text += '\n';
  ErrorSummary last;
  for (Row const& row : rows) {
    last = summarize_errors(comparison.measured.displacement_px, row.truth, comparison.mask);
    text += fmt::format("  {:<25}", row.name);
    for (ErrorMeasure const& measure : all_error_measures())
      if (measure.heading) text += cell(measure, last);
    text += '\n';
  }
  text += fmt::format("  over {} of {} vectors; {} excluded for fewer than three {}\n", last.count(),
                      comparison.vectors_in_file(), comparison.window.left_out, kind.experiment.sources.many);
  if (comparison.left_out.all() > 0) text += "  also excluded: " + comparison.left_out.text() + '\n';
  if (!comparison.report.empty()) text += "  " + comparison.report + '\n';
  text += uncertainty_line(comparison);
  text += '\n';
  text += fmt::format("Error budget          [px]  {:>9} {:>9} {:>9} {:>9} {:>9}\n", "bias u", "bias v", "scatter u",
                      "scatter v", "rms");
  auto const line = [&](BudgetTerm const& term) {
    if (!term.known()) return fmt::format("  {:<25} {:>9}\n", term.name, "unknown");
    return fmt::format("  {:<25} {:9.5f} {:9.5f} {:9.5f} {:9.5f} {:9.5f}\n", term.name, term.bias_u_px, term.bias_v_px,
                       term.random_u_px, term.random_v_px, term.rms_px);
  };
  for (BudgetTerm const& term : comparison.shown_budget().terms) text += line(term);
  text += line(comparison.budget.total);
  text +=
      "  scatter: standard deviation over the vectors of the field; repeats change only the scatter of estimator and "
      "noise\n";
  text += undeformed_line(comparison);
  text += fmt::format(
      "  peak locking {:.5f} px (not part of the sum); the sum of the terms equals the total to {:.1e} px\n",
      comparison.budget.peak_locking_px, comparison.budget.closure_px);
  return text;
}

}  // namespace gladstone::inline compare
