#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "studies/figures/study_figures.h"
#include "studies/report/report_page.h"
#include "studies/sweep/study_table.h"

namespace gladstone::inline report {

/// A study with the quantities of its report.
struct StudyView {
  StudyTable table;
  std::vector<StudyRow const*> finished;
  std::string main;  ///< measure of the measurement error
  std::string against;
  std::vector<std::string> terms;  ///< terms of the budget that are known in some case

  explicit StudyView(std::string const& run);
  double of(StudyRow const& row, std::string const& measure) const {
    auto const at = table.find_measure(measure);
    return at ? row.measures[*at] : std::nan("");
  }
  /// Returns the rms of a budget term [px]: for deforming passes if available, else for undeformed windows.
  double term_rms(StudyRow const& row, std::string const& term) const {
    double const after = of(row, "budget.after_passes.terms." + term + ".rms_px");
    return std::isfinite(after) ? after : of(row, "budget.terms." + term + ".rms_px");
  }
  bool knows(std::string const& measure) const {
    return std::any_of(finished.begin(), finished.end(),
                       [&](StudyRow const* row) { return std::isfinite(of(*row, measure)); });
  }
  /// Returns e.g. "f-number 8, density field late".
  std::string title(StudyRow const& row) const;
  std::vector<double> values(std::string const& measure) const;
};

/// Formats a table of every case with its axes and main measures.
TextTable cases_table(StudyView const& study);

/// Describes the question of the study and its progress.
std::string describe_question(StudyView const& study);

/// Describes the cases with the smallest and largest error.
std::string extremes(StudyView const& study, StudyRow const& best, StudyRow const& worst);

/// Names the points of the study with the smallest error relative to the signal, and with the smallest error of the
/// density gradient, which need not be those with the smallest error in pixels; empty if both are unknown.
std::string other_rankings(StudyView const& study);

/// Describes which cause is the largest, and in how many cases; empty if the budget is unknown.
std::string largest_cause(StudyView const& study);

/// Describes the axis along which the median error changes by the largest factor; empty if no axis has two values.
std::string strongest_axis(StudyView const& study);

/// Describes how well the estimated uncertainties cover the errors; empty if there are no uncertainties.
std::string uncertainty_finding(StudyView const& study);

}  // namespace gladstone::inline report
