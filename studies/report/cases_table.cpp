#include <fmt/format.h>

#include <cmath>

#include "studies/figures/study_axes.h"
#include "studies/report/study_view.h"

namespace gladstone::inline report {
namespace {

constexpr std::size_t longest_plain_table = 20;  ///< maximum number of rows of a table without a search field

}  // namespace

TextTable cases_table(StudyView const& study) {
  TextTable table{
      fmt::format("All cases; study.csv contains all {} measures", study.table.measures.size()), {"case"}, {}};
  std::vector<std::string> measures;
  for (char const* name :
       {"ray_truth.rms_px", "eq9.rms_px", "flow.rms_px", "ray_truth.bias_u_px", "ray_truth.bias_v_px",
        "ray_truth.random_u_px", "ray_truth.random_v_px", "ray_truth.gross_fraction", "ray_truth.valid_fraction",
        "uncertainty.window_truth.coverage_1", "signal_px", "error_over_signal", "gradient_error_kg_m4"}) {
    if (study.knows(name)) measures.emplace_back(name);
  }
  bool const repeated = study.table.repeats() > 1;
  if (repeated) table.header.emplace_back("repeat");
  for (StudyAxis const& axis : study.table.axes) table.header.push_back(axis_title(axis.key));
  table.header.insert(table.header.end(), measures.begin(), measures.end());
  table.header.emplace_back("status");
  for (StudyRow const& row : study.table.rows) {
    std::vector<TableCell> cells{{std::to_string(row.index), static_cast<double>(row.index)}};
    if (repeated) cells.push_back({std::to_string(row.repeat), static_cast<double>(row.repeat)});
    for (std::size_t k = 0; k < study.table.axes.size(); ++k) {
      StudyAxis const& axis = study.table.axes[k];
      TableCell cell{axis.labels[row.value[k]]};
      if (axis.numeric && std::isfinite(axis.numbers[row.value[k]])) cell.number = axis.numbers[row.value[k]];
      cells.push_back(std::move(cell));
    }
    for (std::string const& measure : measures) {
      if (row.status != CaseStatus::ok) {
        cells.push_back({""});
        continue;
      }
      double const value = study.of(row, measure);
      cells.push_back(measure.ends_with("_px") ? TableCell::px(value) : TableCell::of(value));
    }
    cells.push_back({row.error.empty() ? to_string(row.status) : row.error});
    table.rows.push_back(std::move(cells));
  }
  table.filtered = table.rows.size() > longest_plain_table;
  return table;
}

}  // namespace gladstone::inline report
