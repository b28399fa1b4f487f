#pragma once

#include <string>

#include "studies/sweep/study_table.h"

namespace gladstone {

/// Formats a study as CSV: axes by key path, case, seed, status, repeat, all measures, times, device. Numbers are
/// written so that they are read back to the same double; texts are quoted if necessary.
std::string study_csv(StudyTable const& table);

/// Formats the table of study_points() as CSV: axes, first case, all measures.
std::string points_csv(StudyTable const& points);

/// Writes study.h5, with one dataset per column and one value per case; with repeats, the group /points contains the
/// table of study_points(). A column of texts in study.csv is an integer column here: the index into the JSON array in
/// the dataset's attribute `labels`. The builds of gladstone that computed the cases are listed in the root attribute
/// `computed_by` rather than in a dataset, so that equal studies have equal data.
/// @param setup    text of the study file, for the root attribute `setup`
/// @param sources  files from which the table was read
void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources = {});

/// Writes RUN/study.csv, RUN/study.h5 and, with repeats, RUN/study_points.csv from the finished cases. Equal results
/// give equal data.
/// @return the table of the study
/// @throws OutputError if RUN cannot be written (checked first); DataError if the study was planned anew in the
///         meantime
StudyTable collect_study(std::string const& run);

}  // namespace gladstone
