#pragma once

#include <string>
#include <vector>

#include "studies/sweep/manifest.h"
#include "studies/sweep/study_file.h"

namespace gladstone {

/// Every case of a study: repeats outermost, of a grid the last axis fastest, so that neighbours share most. Every
/// value of every axis (of a range that sobol samples: its ends and a sample) is tried by loading its setup whole, with
/// the other axes at their first value (zip: every pair); what goes wrong in other combinations only is left to the
/// run. Seeds of target, pupil and noise derive from the study's seed and the repeat alone; an axis that names a seed
/// wins.
/// @param device "cpu" or "cuda"
/// @throws SetupError at the study's and the base's own lines; DataError for inputs that cannot be read
std::vector<ManifestCase> plan_study(StudyFile const& study, std::string const& device);

/// Tries RUN before a study is planned into it. @throws OutputError where it holds something else, cannot be written,
/// or the plan would write over a file that is read for it
void try_plan_place(std::string const& run, StudyFile const& study);

/// What planning found in RUN.
enum class Planned { fresh, unchanged, replaced };

/// Writes RUN/manifest.jsonl, with a copy of the study beside it. A RUN that is planned already stays as it is where
/// the manifest is the same, and is planned anew where no result would be lost: each that is there belongs to the same
/// line of the new manifest (more repeats come at the end). What a plan that was cut short has left does not stand in
/// the way.
/// @throws OutputError where results would be lost, cases are being computed, or RUN holds something else;
///         DataError where RUN's results are of another version
Planned write_plan(std::string const& run, StudyFile const& study, std::vector<ManifestCase>& cases);

}  // namespace gladstone
