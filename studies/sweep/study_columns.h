#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/base/hdf5_file.h"
#include "studies/sweep/study_table.h"

namespace gladstone {

/// One column of a study's table: numbers, and what its whole numbers stand for.
struct StudyColumn {
  std::string name;
  std::function<double(StudyRow const&)> number;
  std::vector<std::string> labels;  ///< the number is a place in this list; empty: it is itself
  std::string description;
  bool whole = false;
};

/// Of a column by its name: "px", or "1" of a pure number; a statistic of a measure has the measure's unit.
std::string unit_of_column(std::string name);

/// Columns that tell a table's rows apart: its axes and the case.
std::vector<StudyColumn> axis_columns(StudyTable const& table);
/// All columns of study.csv and study.h5.
std::vector<StudyColumn> table_columns(StudyTable const& table);
/// All columns of study_points().
std::vector<StudyColumn> point_columns(StudyTable const& points);

/// @param group "/" or "/points/" @param row_name what a row is
void write_columns(Hdf5Writer& file, std::string const& group, std::string const& row_name, StudyTable const& table,
                   std::vector<StudyColumn> const& columns);

}  // namespace gladstone
