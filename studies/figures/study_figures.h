#pragma once

#include <string>
#include <vector>

#include "studies/drawing/figure.h"
#include "studies/sweep/study_table.h"

namespace gladstone::inline figures {

/// Returns the error budget over every axis with several values, by the titles of the axes; without such an axis, that
/// over the first axis. Empty if the budget is unknown.
std::vector<NamedFigure> make_budget_figures(StudyTable const& table);

/// Draws the figures of a study, each in every format:
///
/// - error_against_AXIS: error of the measurement against ray truth and Eq. 9, with a curve for each combination of the
///   other axes; without other axes, all references in one panel. With more combinations than colours, one curve for
///   each value of the axis with the fewest categories, or a single curve: median and 10-90 % band over all cases.
/// - error_map_AXIS_AXIS: the same errors against two axes, median over the others
/// - budget_AXIS: rms of each term of the error budget, side by side, and of the total
/// - repeats_AXIS: for studies with repeats: systematic part of both errors and standard deviation between repeats
/// Axes with a single value are ignored. Points are the root mean square over repeats; bars extend from minimum to
/// maximum. Unfinished cases are omitted; a study without finished cases has no figures.
/// @param folder   created if it does not exist
/// @param formats  "png", "svg", "pdf"
/// @return paths of the figures
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_study(std::string const& folder, StudyTable const& table,
                                    std::vector<std::string> const& formats = {"png", "svg"});

}  // namespace gladstone::inline figures
