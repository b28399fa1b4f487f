#include "render/files/fields/readers/matlab.h"

#include "analysis/vectors/vector_readers/own_columns.h"
#include "analysis/vectors/vector_readers/vector_readers.h"

namespace gladstone::inline vectors {
namespace {

/// Returns the values of a matrix row by row; MATLAB stores it column by column.
std::vector<double> read_by_rows(ListedArray const& matrix) {
  std::size_t count = 1;
  for (std::size_t const size : matrix.shape) count *= size;
  std::vector<double> by_columns(count);
  matrix.read(0, by_columns);
  if (matrix.shape.size() != 2) return by_columns;
  std::size_t const columns = matrix.shape[0], rows = matrix.shape[1];
  std::vector<double> by_rows(count);
  for (std::size_t i = 0; i < count; ++i) by_rows[i] = by_columns[i % columns * rows + i / columns];
  return by_rows;
}

}  // namespace

VectorFile read_vector_matlab(std::string const& path) {
  OwnColumns columns{path};
  for (ListedArray const& array : list_matlab_arrays(path, "a file of vectors")) {
    if (is_own_column(array.name)) columns.values[array.name] = read_by_rows(array);
  }
  return read_own_columns(columns);
}

}  // namespace gladstone::inline vectors
