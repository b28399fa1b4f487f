#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "studies/sweep/study_columns.h"
#include "studies/sweep/study_table.h"

namespace gladstone::inline sweep {

/// Writes a table as CSV, row by row. Numbers are written so that they are read back to the same double; texts are
/// quoted if necessary.
/// @param columns  table_columns() of a study, or point_columns() of its points
void write_csv(std::ostream& out, StudyTable const& table, std::vector<StudyColumn> const& columns);

/// Writes study.h5, with one dataset per column and one value per case; with repeats, the group /points contains the
/// table of study_points(). A column of texts in study.csv is an integer column here: the index into the JSON array in
/// the dataset's attribute `labels`. The builds of gladstone that computed the cases are listed in the root attribute
/// `computed_by` rather than in a dataset, so that equal studies have equal data.
/// @param setup    text of the study file, for the root attribute `setup`
/// @param sources  files from which the table was read
void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources = {});

/// Writes RUN/study.csv, RUN/study.h5 and, with repeats, RUN/study_points.csv from the finished cases. Equal results
/// give equal data. The files are written in parts; the memory needed is that of the table.
/// @return the table of the study
/// @throws OutputError if RUN cannot be written (checked first); DataError if the study was planned anew in the
///         meantime
StudyTable collect_study(std::string const& run);

}  // namespace gladstone::inline sweep
