#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/vectors/vector_file.h"

namespace gladstone::inline vectors {

/// Columns of a file that gladstone wrote, identified by their names in vectors.csv and vectors.h5.
struct OwnColumns {
  std::string path;
  std::map<std::string, std::vector<double>, std::less<>> values{};
  std::vector<std::size_t> line{};  ///< line number of each vector, from 1; empty: the file is not text
};

/// Returns true if vectors.csv or vectors.h5 has a column of this name: "u_px", "failed_test".
bool is_own_column(std::string_view name);

/// Converts columns to vectors. Columns other than x_px, y_px, u_px and v_px may be missing; the corresponding
/// quantities of the field are then empty.
/// @throws DataError for missing columns, columns of another length than x_px, and numbers that are not codes
VectorFile read_own_columns(OwnColumns const& columns);

}  // namespace gladstone::inline vectors
