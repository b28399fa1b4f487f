#pragma once

#include <string>
#include <vector>

#include "studies/sweep/study_table.h"

namespace gladstone {

/// Draws a study, each figure in every format:
///
/// error_against_AXIS  the error of the measurement against ray truth and against Eq. 9 over the axis, a curve for each
///                     combination of the other axes; without any, all references in one panel. With more combinations
///                     than colours, a curve for each value of the axis of fewest categories, or one alone: the median
///                     of all its cases with the band from 10 to 90 %.
/// error_map_AXIS_AXIS the same errors over two axes, median over the others
/// budget_AXIS         the rms of each term of the error budget, side by side, and of the total
/// repeats_AXIS        of a study with repeats: the part of either error that is the same in every repeat, and the
///                     standard deviation between repeats
///
/// An axis of one value is no axis. Points are the root mean square over repeats, bars reach from the smallest to the
/// largest. Cases that are not done are left out; a study without one has no figures.
/// @param folder  made where it is missing
/// @param formats "png", "svg", "pdf"
/// @return the paths
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_study(std::string const& folder, StudyTable const& table,
                                    std::vector<std::string> const& formats = {"png", "svg"});

}  // namespace gladstone
