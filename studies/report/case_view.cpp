#include "studies/report/case_view.h"

#include <fmt/format.h>

#include <cmath>

#include "analysis/errors/error_summary.h"
#include "analysis/errors/uncertainty_quality.h"
#include "studies/compare/uncorrected_bias.h"

namespace gladstone::inline report {

std::string largest_term(ErrorBudget const& budget) {
  BudgetTerm const* largest = nullptr;
  for (BudgetTerm const& term : budget.terms) {
    if (term.known() && (!largest || term.rms_px > largest->rms_px)) largest = &term;
  }
  if (!largest) return "";
  return fmt::format(
      "The largest cause of error is {}, with a bias of ({}, {}) px, a scatter over the field of "
      "({:.2g}, {:.2g}) px and an rms of {:.3g} px; the total rms is {:.3g} px.",
      largest->name, TableCell::px(largest->bias_u_px).text, TableCell::px(largest->bias_v_px).text,
      largest->random_u_px, largest->random_v_px, largest->rms_px, budget.total.rms_px);
}

std::string explain_budget(Comparison const& all) {
  std::string text =
      "Scatter is the standard deviation over the vectors of the field. For estimator and noise it varies between "
      "repeats, because dots and noise change; for the other causes it is the same in every repeat.";
  if (all.frames_deformed) {
    text +=
        " Window is the loss that remains after the passes that deform the frames, and estimator is the error added to "
        "it. errors.json contains both under budget.after_passes; under budget.terms they refer to an undeformed "
        "window, whose loss later passes recover in part.";
  }
  return text;
}

std::vector<std::string> uncertainty_statements(CaseView const& view) {
  Comparison const& all = view.comparison;
  char const* const truth = all.recorded_name();
  std::vector<std::string> statements;
  UncertaintyQuality quality{};  // stays empty for vectors without uncertainties
  if (!all.measured.sigma_px.empty()) {
    quality = uncertainty_quality(all.measured.displacement_px, all.recorded().displacement_px, all.measured.sigma_px,
                                  all.mask);
  }
  if (quality.count > 0) {
    std::vector<double> sigmas;
    for (std::size_t i = 0; i < all.mask.size(); ++i) {
      if (!all.mask[i]) continue;
      for (double const one : {all.measured.sigma_px[i].x, all.measured.sigma_px[i].y}) {
        if (std::isfinite(one)) sigmas.push_back(one);
      }
    }
    statements.push_back(fmt::format(
        "The estimator's standard uncertainty is {:.3g} px in the median ({:.3g} to {:.3g} px for 10 to 90 % of the "
        "components). It covers {:.1f} % of the errors against {} (ideal: 68.3 %), twice the uncertainty {:.1f} % "
        "(ideal: 95.4 %); {} components; excluded: {} vectors with gross errors, {} without an uncertainty.",
        quantile(sigmas, 0.5), quantile(sigmas, 0.1), quantile(sigmas, 0.9), 100 * quality.coverage_1, truth,
        100 * quality.coverage_2, quality.count, quality.gross, quality.without_sigma));
    statements.push_back(fmt::format("Its rms is {:.2f} times the rms error. {}", quality.rms_ratio,
                                     quality.rms_ratio < 0.85 ? "It is too small: divide it by this factor before use."
                                     : quality.rms_ratio > 1.15 ? "It is too large, that is, conservative."
                                                                : "The deviation is less than 15 %."));
  }
  ErrorSummary const error =
      summarize_errors(all.measured.displacement_px, all.recorded().displacement_px, all.mask, all.vectors_in_file());
  double const u = std::hypot(error["bias_u_px"], error["random_u_px"]),
               v = std::hypot(error["bias_v_px"], error["random_v_px"]);
  statements.push_back(
      fmt::format("The combined standard uncertainty is {:.3g} px of the component u and {:.3g} px of v, of type B: "
                  "the rms error against {}, due to estimator and noise, over the {} vectors of this simulated "
                  "measurement. The expanded uncertainty is {:.3g} and {:.3g} px with a coverage factor of 2.",
                  u, v, truth, all.budget.count, 2 * u, 2 * v));
  statements.push_back(fmt::format("The uncorrected bias is {:.3g} px: {}", uncorrected_bias_px(all),
                                   describe_uncorrected_bias(comparison_kind(all))));
  return statements;
}

std::vector<std::string> summarize_findings(CaseView const& view) {
  Comparison const& all = view.comparison;
  ComparisonKind const& kind = comparison_kind(all);
  std::vector<std::string> findings;
  auto const rms = [&](std::vector<Vec2d> const& truth) {
    return summarize_errors(all.measured.displacement_px, truth, all.mask, all.vectors_in_file());
  };
  ErrorSummary const truth = rms(all.point.displacement_px);
  ErrorSummary const theory = rms(kind.references.front().of(all));
  findings.push_back(
      fmt::format("The rms error of the measurement is {:.3g} px against ray truth and {:.3g} px against {}; {} of {} "
                  "vectors count, {:.2g} % of them with gross errors.",
                  truth["rms_px"], theory["rms_px"], kind.theory, truth.count(), all.vectors_in_file(),
                  100 * truth["gross_fraction"]));
  if (std::string const cause = largest_term(all.shown_budget()); !cause.empty()) findings.push_back(cause);
  findings.push_back(uncertainty_statements(view).front());
  for (std::string const& warning : to_strings(all.warnings)) findings.push_back("Warning: " + warning + '.');
  return findings;
}

Chart budget_chart(std::string const& title, Figure figure, ErrorBudget const& budget) {
  return {"budget", title, largest_term(budget), {{"", std::move(figure)}}};
}

TextTable budget_table(std::string const& title, ErrorBudget const& budget) {
  TextTable table{title, {"cause", "bias u", "bias v", "scatter u", "scatter v", "rms"}, {}};
  auto const add = [&](BudgetTerm const& term) {
    table.rows.push_back({{term.name},
                          TableCell::px(term.bias_u_px),
                          TableCell::px(term.bias_v_px),
                          TableCell::px(term.random_u_px),
                          TableCell::px(term.random_v_px),
                          TableCell::px(term.rms_px)});
  };
  for (BudgetTerm const& term : budget.terms) add(term);
  add(budget.total);
  return table;
}

}  // namespace gladstone::inline report
