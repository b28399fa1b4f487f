#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare/comparison_kind.h"
#include "studies/figures/error_figures.h"
#include "studies/figures/map_figures.h"
#include "studies/report/report_page.h"

namespace gladstone::inline report {

/// A comparison with the maps and the error series of its report.
struct CaseView {
  Comparison comparison;
  std::vector<NamedFigure> maps;  ///< empty for vectors that are not on a grid
  std::vector<ErrorSeries> errors;

  explicit CaseView(Comparison compared) : comparison(std::move(compared)) {}

  /// Adds maps of values to 1e-6 px, far below the resolution of any measurement.
  void add_map(std::string name, std::vector<Vec2d> values) {
    DisplacementField const& lattice = comparison.measured;
    if (values.empty() || lattice.columns <= 1 || lattice.rows <= 1) return;
    for (Vec2d& value : values) value = Vec2d{std::round(value.x * 1e6), std::round(value.y * 1e6)} / 1e6;
    maps.push_back({std::move(name), make_vector_maps(lattice, values, "px")});
  }
  /// Adds the measurement minus a reference at the compared vectors.
  void add_error(std::string const& against, std::vector<Vec2d> const& reference) {
    std::vector<Vec2d> error(reference.size(), Vec2d{std::nan(""), std::nan("")});
    for (std::size_t i = 0; i < error.size(); ++i) {
      if (comparison.mask[i]) error[i] = comparison.measured.displacement_px[i] - reference[i];
    }
    add_map("error " + against, error);
    errors.push_back({against, std::move(error)});
  }
};

/// Formats the terms of a budget and their total as a table.
TextTable budget_table(std::string const& title, ErrorBudget const& budget);

/// Returns the chart of the terms of a budget.
Chart budget_chart(std::string const& title, Figure figure, ErrorBudget const& budget);

/// Returns a sentence about the largest term of the budget; empty if no term is known.
std::string largest_term(ErrorBudget const& budget);

/// Returns an explanation of the budget's terms.
std::string explain_budget(Comparison const& all);

/// Returns the statements of an uncertainty report in the terms of the GUM (JCGM 100:2008).
std::vector<std::string> uncertainty_statements(CaseView const& view);

/// Returns the main results for the beginning of the report.
std::vector<std::string> summarize_findings(CaseView const& view);

}  // namespace gladstone::inline report
