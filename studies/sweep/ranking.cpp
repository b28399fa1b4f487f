#include "studies/sweep/ranking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace gladstone::inline sweep {
namespace {

constexpr std::size_t points_in_text = 3;

/// Returns the mean of a measure over the finished repeats of a point; nullopt if no repeat has it.
std::optional<double> mean_of_point(StudyTable const& table, StudyPoint const& point, std::size_t measure) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t const row : point.rows) {
    double const value = table.rows[row].measures[measure];
    if (table.rows[row].status != CaseStatus::ok || !std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

bool is_known(StudyTable const& table, std::string const& name) {
  auto const measure = table.find_measure(name);
  return measure && std::any_of(table.points.begin(), table.points.end(), [&](StudyPoint const& point) {
           return mean_of_point(table, point, *measure).has_value();
         });
}

}  // namespace

std::string main_error_measure(StudyTable const& table) {
  for (char const* const name : {"eq9.rms_px", "flow.rms_px"}) {
    if (is_known(table, name)) return name;
  }
  return "ray_truth.rms_px";
}

std::vector<StudyRanking> rank_points(StudyTable const& table) {
  std::vector<StudyRanking> rankings;
  for (auto const& [name, meaning] : {std::pair<std::string, char const*>{main_error_measure(table), "error"},
                                      {"error_over_signal", "error relative to the signal"},
                                      {"gradient_error_kg_m4", "error of the density gradient"}}) {
    auto const measure = table.find_measure(name);
    if (!measure || !is_known(table, name)) continue;
    StudyRanking ranking{name, meaning, {}};
    for (StudyPoint const& point : table.points) {
      if (auto const value = mean_of_point(table, point, *measure)) {
        ranking.points.push_back({point.rows.front(), *value});
      }
    }
    std::stable_sort(ranking.points.begin(), ranking.points.end(),
                     [](RankedPoint const& a, RankedPoint const& b) { return a.value < b.value; });
    rankings.push_back(std::move(ranking));
  }
  return rankings;
}

std::string point_title(StudyTable const& table, StudyRow const& row) {
  std::string text;
  for (std::size_t k = 0; k < table.axes.size(); ++k) {
    StudyAxis const& axis = table.axes[k];
    if (axis.labels.size() < 2) continue;
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", axis.key, axis.labels[row.value[k]]);
  }
  return text;
}

std::string ranking_text(StudyTable const& table, std::vector<StudyRanking> const& rankings) {
  std::string text;
  for (StudyRanking const& ranking : rankings) {
    text += fmt::format("smallest {} ({})\n", ranking.meaning, ranking.measure);
    for (std::size_t i = 0; i < std::min(points_in_text, ranking.points.size()); ++i) {
      StudyRow const& row = table.rows[ranking.points[i].row];
      text += fmt::format("  {:<12.4g}case {:<6}{}\n", ranking.points[i].value, row.index, point_title(table, row));
    }
  }
  return text;
}

nlohmann::ordered_json ranking_json(StudyTable const& table, std::vector<StudyRanking> const& rankings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (StudyRanking const& ranking : rankings) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (RankedPoint const& point : ranking.points) {
      points.push_back({{"case", table.rows[point.row].index}, {"value", point.value}});
    }
    json.push_back({{"measure", ranking.measure}, {"meaning", ranking.meaning}, {"points", points}});
  }
  return json;
}

}  // namespace gladstone::inline sweep
