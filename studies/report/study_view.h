#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/report/report_page.h"
#include "studies/sweep/study_table.h"

namespace gladstone {

/// Share of the errors against truth on the window that are below their estimated uncertainty.
inline constexpr char const* coverage_measure = "uncertainty.window_truth.coverage_1";
inline constexpr std::size_t most_places = 24;  ///< of an axis in a chart; more values are gathered

/// A study as its report asks it.
struct StudyView {
  StudyTable table;
  std::vector<StudyRow const*> finished;
  std::string main;  ///< the measure that says how wrong the measurement is
  std::string against;
  std::vector<std::string> terms;  ///< of the budget, those that some case knows

  explicit StudyView(std::string const& run);
  double of(StudyRow const& row, std::string const& measure) const {
    auto const at = table.find_measure(measure);
    return at ? row.measures[*at] : std::nan("");
  }
  /// rms of a term of the budget: after the passes that deform the frames, where there are such [px].
  double term_rms(StudyRow const& row, std::string const& term) const {
    double const after = of(row, "budget.after_passes.terms." + term + ".rms_px");
    return std::isfinite(after) ? after : of(row, "budget.terms." + term + ".rms_px");
  }
  bool knows(std::string const& measure) const {
    return std::any_of(finished.begin(), finished.end(),
                       [&](StudyRow const* row) { return std::isfinite(of(*row, measure)); });
  }
  /// "f-number 8, density field late"
  std::string title(StudyRow const& row) const;
  std::vector<double> values(std::string const& measure) const;
};

/// What charts are drawn from: axes, measures that some case knows, and the cases.
nlohmann::json study_data(StudyView const& study);

/// Every case with its axes and main measures.
TextTable cases_table(StudyView const& study);

/// What the study asks, and how far it is.
std::string question_of(StudyView const& study);

/// Between which cases the error lies.
std::string extremes(StudyView const& study, StudyRow const& best, StudyRow const& worst);

/// Which cause is the largest in how many cases. Empty where the budget is not known.
std::string largest_cause(StudyView const& study);

/// The axis along which the median error changes by the largest factor. Empty where no axis has two values.
std::string strongest_axis(StudyView const& study);

/// Whether the estimated uncertainties tell the errors. Empty where there are none.
std::string uncertainty_finding(StudyView const& study);

}  // namespace gladstone
