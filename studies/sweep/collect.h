#pragma once

#include <string>

#include "studies/sweep/study_table.h"

namespace gladstone {

/// A study as text: the axes by key path, case, seed, status, the repeat and every measure, times, device. Numbers read
/// back to the same double; texts stand in quotes where they must.
std::string study_csv(StudyTable const& table);

/// The table of study_points() as text: the axes, the first case, every measure.
std::string points_csv(StudyTable const& points);

/// Writes study.h5: a dataset a column, of one value a case; of a study with repeats also its points, in the group
/// /points. What is a text in study.csv is a whole number here, the
/// place in the dataset's attribute `labels`, a JSON array. The root attribute `computed_by` names the builds of
/// gladstone that computed the cases, no dataset: the same study has the same data.
/// @param setup   text of the study file, for the root attribute of that name
/// @param sources what the table was read from
void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources = {});

/// Writes RUN/study.csv and RUN/study.h5 from what is finished, and with repeats RUN/study_points.csv: equal results,
/// equal data. @return the table @throws OutputError, before anything is read, where RUN cannot be written; DataError
/// where the study was planned anew meanwhile
StudyTable collect_study(std::string const& run);

}  // namespace gladstone
