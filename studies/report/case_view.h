#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare/comparison_kind.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// Returns one component of the displacements as a map of the report: integer multiples of 1e-6 px, null if unknown.
inline nlohmann::json component_json(std::vector<Vec2d> const& values, double Vec2d::*component) {
  nlohmann::json json = nlohmann::json::array();
  for (Vec2d const& value : values) {
    double const number = value.*component;
    json.push_back(std::isfinite(number) ? nlohmann::json(std::round(number * 1e6) * 1e-6) : nlohmann::json(nullptr));
  }
  return json;
}

/// A comparison with the maps of its report.
struct CaseView {
  Comparison comparison;
  nlohmann::json fields = nlohmann::json::array();
  nlohmann::json errors = nlohmann::json::array();

  explicit CaseView(Comparison compared) : comparison(std::move(compared)) {}

  void add_field(std::string const& name, std::string const& title, std::vector<Vec2d> const& values) {
    if (values.empty()) return;
    fields.push_back({{"name", name},
                      {"title", title},
                      {"u", component_json(values, &Vec2d::x)},
                      {"v", component_json(values, &Vec2d::y)}});
  }
  /// Returns `to` minus `from` at the compared vectors, NaN at the others.
  std::vector<Vec2d> difference(std::vector<Vec2d> const& to, std::vector<Vec2d> const& from) const {
    if (to.empty() || from.empty()) return {};
    std::vector<Vec2d> values(to.size(), Vec2d{std::nan(""), std::nan("")});
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (comparison.mask[i]) values[i] = to[i] - from[i];
    }
    return values;
  }
  void add_error(std::string const& name, std::string const& title, std::vector<Vec2d> const& truth) {
    std::vector<Vec2d> const values = difference(comparison.measured.displacement_px, truth);
    errors.push_back({{"name", name},
                      {"title", title},
                      {"u", component_json(values, &Vec2d::x)},
                      {"v", component_json(values, &Vec2d::y)}});
    add_field(name, "error " + title, values);
  }
};

/// Formats the terms of a budget and their total as a table.
TextTable budget_table(std::string const& title, ErrorBudget const& budget);

/// Returns the known terms as data of the chart "budget".
nlohmann::json budget_json(ErrorBudget const& budget);

/// Returns a sentence about the largest term of the budget; empty if no term is known.
std::string largest_term(ErrorBudget const& budget);

/// Returns an explanation of the budget's terms.
std::string explain_budget(Comparison const& all);

/// Returns the statements of an uncertainty report in the terms of the GUM (JCGM 100:2008).
std::vector<std::string> uncertainty_statements(CaseView const& view);

/// Returns the main results for the beginning of the report.
std::vector<std::string> summarize_findings(CaseView const& view);

}  // namespace gladstone
