#pragma once

#include <string>

#include "studies/sweep/study_plan.h"

namespace gladstone {

/// Tries RUN before a study is planned into it. @throws OutputError where it holds something else, cannot be written,
/// or the plan would write over a file that is read for it
void try_plan_place(std::string const& run, StudyFile const& study);

/// What planning found in RUN.
enum class Planned { fresh, unchanged, replaced };

/// Writes RUN/manifest.jsonl, with a copy of the study and of its base beside it. A RUN that is planned already stays
/// as it is where the manifest is the same, and is planned anew where no result would be lost: each that is there
/// belongs to the same line of the new manifest (more repeats come at the end). What a plan that was cut short has left
/// does not stand in the way. Lines are made in parallel and written as they come, some thousands at a time.
/// @throws OutputError where results would be lost, cases are being computed, or RUN holds something else;
///         DataError where RUN's results are of another version, or an input cannot be read
Planned write_plan(std::string const& run, StudyPlan const& plan);

}  // namespace gladstone
