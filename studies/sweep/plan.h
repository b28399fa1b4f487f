#pragma once

#include <string>

#include "studies/sweep/study_plan.h"

namespace gladstone::inline sweep {

/// Checks whether a study can be planned into RUN.
/// @throws OutputError if RUN contains something other than a study, cannot be written, or the plan would overwrite one
/// of its inputs
void check_plan_folder(std::string const& run, StudyFile const& study);

/// Result of planning: into a new folder, onto an identical plan, or replacing a different plan.
enum class PlanOutcome { fresh, unchanged, replaced };

/// Writes RUN/manifest.jsonl and copies of the study file and its base setup. An existing identical manifest is left
/// unchanged. A different one is replaced if no result would be lost, that is, if every existing result belongs to the
/// same line of the new manifest (additional repeats are appended). Remains of an interrupted plan are overwritten.
/// Lines are generated in parallel and written in blocks of some thousand.
/// @throws OutputError if results would be lost, cases are being computed, or RUN contains something else; DataError if
///         results in RUN are of another version, or an input cannot be read
PlanOutcome write_plan(std::string const& run, StudyPlan const& plan);

}  // namespace gladstone::inline sweep
