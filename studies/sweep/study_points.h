#pragma once

#include "studies/sweep/study_table.h"

namespace gladstone {

/// The points of a study as a table of their own, a row a point: what its repeats have in common and how far they
/// scatter. A row's index is that of the point's first case, its status ok where a repeat is finished (the first that
/// is not, else). Measures:
///
/// repeats, vectors            finished repeats; vectors that count in all of them
/// ERROR.systematic_px         of ERROR = ray_truth, eq9: rms of what is the same in every repeat (RepeatSplit)
/// ERROR.scatter_px            standard deviation between repeats
/// budget.estimator_px         the budget's estimator term with repeats: the mean over their patterns
/// budget.pattern_px           and its pattern term: what changes from pattern to pattern, without noise
/// MEASURE.mean, MEASURE.std   of every measure of the cases: mean and sample standard deviation over the repeats
///
/// What takes two repeats is NaN with one.
StudyTable study_points(StudyTable const& cases);

}  // namespace gladstone
