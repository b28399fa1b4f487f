#include "studies/sweep/study_points.h"

#include <array>

#include "render/base/contracts.h"

namespace gladstone::inline sweep {
namespace {

struct SplitNames {
  char const* systematic;
  char const* scatter;
};
/// Names of the measures with systematic error and scatter, in the order of vector_error_names().
constexpr std::array<SplitNames, 3> split_names{{{"ray_truth.systematic_px", "ray_truth.scatter_px"},
                                                 {"eq9.systematic_px", "eq9.scatter_px"},
                                                 {"budget.estimator_px", "budget.pattern_px"}}};

StudyRow row_of(StudyTable const& cases, StudyPoint const& point) {
  GLADSTONE_EXPECTS(point.splits.size() == split_names.size());
  std::vector<StudyRow const*> finished;
  for (std::size_t const i : point.rows) {
    if (cases.rows[i].status == CaseStatus::ok) finished.push_back(&cases.rows[i]);
  }
  StudyRow row = cases.rows[point.rows.front()];
  if (!finished.empty()) row.status = CaseStatus::ok;
  row.measures = {static_cast<double>(finished.size()), static_cast<double>(point.splits.front().vectors)};
  for (RepeatSplit const& split : point.splits) {
    row.measures.push_back(split.systematic_px);
    row.measures.push_back(split.scatter_px);
  }
  for (std::size_t m = 0; m < cases.measures.size(); ++m) {
    std::vector<double> values;
    for (StudyRow const* one : finished) values.push_back(one->measures[m]);
    MeanAndSpread const both = mean_and_spread(values);
    row.measures.push_back(both.mean);
    row.measures.push_back(both.spread);
  }
  return row;
}

}  // namespace

StudyTable study_points(StudyTable const& cases) {
  StudyTable table;
  table.name = cases.name;
  table.axes = cases.axes;
  table.measures = {"repeats", "vectors"};
  for (SplitNames const& names : split_names) {
    table.measures.emplace_back(names.systematic);
    table.measures.emplace_back(names.scatter);
  }
  for (std::string const& measure : cases.measures) {
    table.measures.push_back(measure + ".mean");
    table.measures.push_back(measure + ".std");
  }
  for (StudyPoint const& point : cases.points) table.rows.push_back(row_of(cases, point));
  return table;
}

}  // namespace gladstone::inline sweep
