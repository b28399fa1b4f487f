#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "studies/sweep/study_table.h"

namespace gladstone::inline sweep {

/// Column of a study's table.
struct StudyColumn {
  std::string name;
  std::function<double(StudyRow const&)> number;
  /// texts to which the numbers are indices; empty: the numbers are the values
  std::vector<std::string> labels;
  std::string description;
  bool whole = false;
};

/// Returns the unit of a column from its name: "px", or "1" if dimensionless. A statistic of a measure has the
/// measure's unit.
std::string unit_of_column(std::string name);

/// Returns the columns that identify a row: the axes and the case.
std::vector<StudyColumn> axis_columns(StudyTable const& table);
/// Returns all columns of study.csv and study.h5.
std::vector<StudyColumn> table_columns(StudyTable const& table);
/// Returns all columns of study_points().
std::vector<StudyColumn> point_columns(StudyTable const& points);

/// Writes columns to an HDF5 group. Their axis is the column "case".
/// @param group     "/" or "/points/"
/// @param row_name  meaning of a row, as axis name of the datasets
void write_columns(Hdf5Writer& file, Hdf5Axes& axes, std::string const& group, std::string const& row_name,
                   StudyTable const& table, std::vector<StudyColumn> const& columns);

}  // namespace gladstone::inline sweep
