#include "studies/report/study_view.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "analysis/errors/error_summary.h"
#include "render/base/error.h"
#include "studies/figures/study_axes.h"
#include "studies/sweep/job_array.h"
#include "studies/sweep/ranking.h"
#include "studies/sweep/study_columns.h"

namespace gladstone::inline report {
namespace {

constexpr std::size_t longest_plain_table = 20;  ///< maximum number of rows of a table without a search field
constexpr std::size_t most_positions = 24;       ///< maximum number of positions on an axis; more values are binned

}  // namespace

StudyView::StudyView(std::string const& run) : table(read_study_table(run)) {
  for (StudyRow const& row : table.rows) {
    if (row.status == CaseStatus::ok) finished.push_back(&row);
  }
  if (finished.empty()) {
    throw DataError(ErrorCode::missing_content, run,
                    "contains no finished case; run gladstone sweep run " + shell_word(run) + " first");
  }
  main = main_error_measure(table);
  against = main == "eq9.rms_px"    ? "Eq. 9 (the displacement by the density gradient)"
            : main == "flow.rms_px" ? "the displacement of the flow"
                                    : "ray truth";
  if (!knows(main)) {
    throw DataError(ErrorCode::missing_content, run,
                    "contains no measured case, only images (sweep run --pairs-only); run gladstone sweep run " +
                        shell_word(run) + " first");
  }
  for (std::string const& measure : table.measures) {
    std::string_view constexpr head = "budget.terms.", tail = ".rms_px";
    if (measure.starts_with(head) && measure.ends_with(tail) && knows(measure)) {
      terms.push_back(measure.substr(head.size(), measure.size() - head.size() - tail.size()));
    }
  }
}

std::string StudyView::title(StudyRow const& row) const {
  std::string text;
  for (std::size_t k = 0; k < table.axes.size(); ++k) {
    if (table.axes[k].labels.size() < 2) continue;
    text +=
        (text.empty() ? "" : ", ") + axis_value_text(axis_title(table.axes[k].key), table.axes[k].labels[row.value[k]]);
  }
  return text.empty() ? fmt::format("case {}", row.index) : text;
}

std::vector<double> StudyView::values(std::string const& measure) const {
  std::vector<double> known;
  for (StudyRow const* row : finished) {
    if (double const value = of(*row, measure); std::isfinite(value)) known.push_back(value);
  }
  return known;
}

std::string describe_question(StudyView const& study) {
  std::string axes;
  for (StudyAxis const& axis : study.table.axes) {
    if (axis.labels.size() < 2) continue;
    axes += fmt::format("{}{} ({} values)", axes.empty() ? "" : ", ", axis_title(axis.key), axis.labels.size());
  }
  return fmt::format("How large is the error of the measured displacement against {}{}? {} of {} cases are finished.",
                     study.against, axes.empty() ? "" : " over " + axes, study.finished.size(),
                     study.table.rows.size());
}

std::string extremes(StudyView const& study, StudyRow const& best, StudyRow const& worst) {
  return fmt::format(
      "The rms error against {} lies between {:.3g} px ({}) and {:.3g} px ({}); its median is {:.3g} px.",
      study.against, study.of(best, study.main), study.title(best), study.of(worst, study.main), study.title(worst),
      quantile(study.values(study.main), 0.5));
}

std::string other_rankings(StudyView const& study) {
  std::string text;
  for (StudyRanking const& ranking : rank_points(study.table)) {
    if (ranking.measure == study.main) continue;
    StudyRow const& best = study.table.rows[ranking.points.front().row];
    std::string const unit = unit_of_column(ranking.measure);
    text +=
        fmt::format("{}{} {} is smallest for {}: {:.3g}{}", text.empty() ? "" : "; ", text.empty() ? "The" : "the",
                    ranking.meaning, study.title(best), ranking.points.front().value, unit == "1" ? "" : " " + unit);
  }
  return text.empty() ? text : text + '.';
}

std::string largest_cause(StudyView const& study) {
  std::vector<std::size_t> wins(study.terms.size());
  std::size_t judged = 0;
  for (StudyRow const* row : study.finished) {
    std::size_t largest = study.terms.size();
    double most = -1;
    for (std::size_t k = 0; k < study.terms.size(); ++k) {
      double const rms = study.term_rms(*row, study.terms[k]);
      if (rms > most) {
        most = rms;
        largest = k;
      }
    }
    if (largest == study.terms.size()) continue;
    ++wins[largest];
    ++judged;
  }
  if (judged == 0) return "";
  auto const first = static_cast<std::size_t>(std::max_element(wins.begin(), wins.end()) - wins.begin());
  std::vector<double> known;
  for (StudyRow const* row : study.finished) {
    if (double const rms = study.term_rms(*row, study.terms[first]); std::isfinite(rms)) known.push_back(rms);
  }
  return fmt::format("The largest cause of error is {} in {} of {} cases, with a median rms of {:.3g} px.",
                     study.terms[first], wins[first], judged, quantile(std::move(known), 0.5));
}

std::string strongest_axis(StudyView const& study) {
  double strongest = 0;
  std::string text;
  for (std::size_t k = 0; k < study.table.axes.size(); ++k) {
    StudyAxis const& axis = study.table.axes[k];
    FigureAxis const places = figure_axis(axis, most_positions);
    double least = std::numeric_limits<double>::infinity(), most = 0;
    std::string least_at, most_at;
    for (std::size_t i = 0; i < places.size(); ++i) {
      std::vector<double> here;
      for (StudyRow const* row : study.finished) {
        double const value = study.of(*row, study.main);
        if (places.place_of[row->value[k]] == i && std::isfinite(value)) here.push_back(value);
      }
      double const median = quantile(std::move(here), 0.5);
      if (median < least) least = median, least_at = places.label[i];
      if (median > most) most = median, most_at = places.label[i];
    }
    if (!(most > least) || !(most / least > strongest)) continue;
    strongest = most / least;
    text = fmt::format("The most influential axis is {}: the median error is {:.3g} px at {} and {:.3g} px at {}.",
                       places.title, least, least_at, most, most_at);
  }
  return text;
}

std::string uncertainty_finding(StudyView const& study) {
  std::vector<double> const coverage = study.values(coverage_measure);
  if (coverage.empty()) return "";
  return fmt::format(
      "The estimated uncertainty covers {:.0f} % of the errors in the median case ({:.0f} to {:.0f} %; ideal: 68 %).",
      100 * quantile(coverage, 0.5), 100 * quantile(coverage, 0), 100 * quantile(coverage, 1));
}

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
