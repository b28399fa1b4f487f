#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// Displacements at the vectors as a map of the report: whole multiples of 1e-6 px, null where unknown.
inline nlohmann::json component_json(std::vector<Vec2d> const& values, double Vec2d::*component) {
  nlohmann::json json = nlohmann::json::array();
  for (Vec2d const& value : values) {
    double const number = value.*component;
    json.push_back(std::isfinite(number) ? nlohmann::json(std::round(number * 1e6) * 1e-6) : nlohmann::json(nullptr));
  }
  return json;
}

/// A comparison as its report shows it.
struct CaseView {
  Comparison comparison;
  bool piv = false;
  nlohmann::json fields = nlohmann::json::array();
  nlohmann::json errors = nlohmann::json::array();

  explicit CaseView(Comparison compared) : comparison(std::move(compared)), piv(comparison.chain == BudgetChain::piv) {}

  void add_field(std::string const& name, std::string const& title, std::vector<Vec2d> const& values) {
    if (values.empty()) return;
    fields.push_back({{"name", name},
                      {"title", title},
                      {"u", component_json(values, &Vec2d::x)},
                      {"v", component_json(values, &Vec2d::y)}});
  }
  /// What `to` is beyond `from`, at the vectors that count.
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

/// The terms of a budget, and their total.
TextTable budget_table(std::string const& title, ErrorBudget const& budget);

/// The same as data of the chart "budget", those that are known.
nlohmann::json budget_json(ErrorBudget const& budget);

/// What the budget's largest term is, in a sentence; empty where none is known.
std::string largest_term(ErrorBudget const& budget);

/// What the words of a budget's table mean.
std::string budget_words(Comparison const& all);

/// What an uncertainty report says in the words of the GUM (JCGM 100:2008).
std::vector<std::string> uncertainty_statements(CaseView const& view);

/// What a reader is to know before all else.
std::vector<std::string> findings_of(CaseView const& view);

}  // namespace gladstone
