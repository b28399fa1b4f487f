#include "studies/compare/error_report.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "analysis/errors/uncertainty_quality.h"
#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {
namespace {

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
