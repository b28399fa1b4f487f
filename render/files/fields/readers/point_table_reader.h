#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/base/warning.h"

namespace gladstone::inline files {

/// Column of a table: its name and unit, and its values.
struct PointColumn {
  std::string name, unit;
  std::vector<double> values;
};

/// Table of points as in the file; all columns have one value per point.
struct PointTable {
  std::vector<PointColumn> columns;
  std::vector<std::size_t> line;  ///< line of each point, from 1
  Warnings notes;
};

/// Reads a table of points: text with a header line that names the columns, or the first zone of a Tecplot file.
/// @throws DataError with file:line for a row that is not numbers or has another number of columns than the header
PointTable read_point_table(std::string const& path);

}  // namespace gladstone::inline files
