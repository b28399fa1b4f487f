#pragma once

#include "studies/sweep/study_table.h"

namespace gladstone::inline sweep {

/// Computes the table of a study's points, one row per point: statistics over the repeats. A row has the index of the
/// point's first case, and status ok if at least one repeat is finished (otherwise the status of the first case).
/// Measures:
///
///   repeats, vectors            number of finished repeats; number of vectors compared in all of them
///   ERROR.systematic_px         for ERROR = ray_truth, eq9: rms of the part common to all repeats (RepeatSplit)
///   ERROR.scatter_px            standard deviation between repeats
///   budget.estimator_px         estimator term of the budget with repeats: mean over the patterns
///   budget.pattern_px           pattern term of the budget: variation between patterns, without noise
///   MEASURE.mean, MEASURE.std   mean and sample standard deviation over the repeats, for every measure of the cases
///
/// Statistics that require two repeats are NaN for a single one.
/// @pre a point of the study has more than one repeat
StudyTable study_points(StudyTable const& cases);

}  // namespace gladstone::inline sweep
