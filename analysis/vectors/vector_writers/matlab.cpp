#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"
#include "render/base/version.h"

namespace gladstone::inline vectors {
namespace {

/// Data types and array class of the format (MathWorks, "MAT-File Format", tables 1-1 and 1-3).
constexpr std::uint32_t mi_int8 = 1, mi_int32 = 5, mi_uint32 = 6, mi_double = 9, mi_matrix = 14, mx_double_class = 6;

template <class Value>
void append_value(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<char const*>(&value), sizeof value);
}

/// Appends a data element: its tag and its bytes, padded to a multiple of 8; up to 4 bytes are stored in the tag.
void append_element(std::string& bytes, std::uint32_t type, std::string const& data) {
  auto const size = static_cast<std::uint32_t>(data.size());
  bool const small = size <= 4;
  append_value(bytes, small ? size << 16 | type : type);
  if (!small) append_value(bytes, size);
  bytes += data;
  bytes.append((small ? 4 - size : (8 - size % 8) % 8), '\0');
}

/// Returns the values of a matrix as MATLAB stores it, column by column.
std::string column_major(std::vector<double> const& values, std::size_t rows, std::size_t columns) {
  std::string bytes;
  bytes.reserve(values.size() * sizeof(double));
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) append_value(bytes, values[row * columns + column]);
  }
  return bytes;
}

/// @param layers  1: a matrix of rows and columns; more: an array [columns, rows, layers], as ndgrid(x, y, z) makes it
std::string matrix_element(VectorColumn const& column, std::size_t rows, std::size_t columns, std::size_t layers) {
  std::string flags, sizes, matrix, element;
  append_value(flags, mx_double_class);
  append_value(flags, std::uint32_t{0});
  std::vector<std::size_t> shape{rows, columns};
  if (layers > 1) shape = {columns, rows, layers};
  for (std::size_t const size : shape) append_value(sizes, static_cast<std::int32_t>(size));
  append_element(matrix, mi_uint32, flags);
  append_element(matrix, mi_int32, sizes);
  append_element(matrix, mi_int8, column.name);
  append_element(
      matrix, mi_double,
      layers > 1 ? column_major(column.values, column.values.size(), 1) : column_major(column.values, rows, columns));
  append_element(element, mi_matrix, matrix);
  return element;
}

}  // namespace

void write_matlab_table(std::string const& path, VectorTable const& table, FileOrigin const& origin) {
  constexpr std::size_t most = std::numeric_limits<std::int32_t>::max() / sizeof(double) - 64;
  if (table.rows() > most) {
    throw OutputError(path, fmt::format("cannot store {} values (MATLAB's level 5 format is limited to 2 GiB per "
                                        "matrix); write .h5",
                                        table.rows()));
  }
  bool const grid = table.grid_columns > 0;
  std::size_t const rows = grid ? static_cast<std::size_t>(table.grid_rows) : table.rows();
  std::size_t const columns = grid ? static_cast<std::size_t>(table.grid_columns) : 1;
  std::string bytes = fmt::format("MATLAB 5.0 MAT-file, gladstone {} {}, {}", version, table.content, table.remark);
  constexpr std::size_t text_bytes = 116, subsystem_bytes = 8;
  bytes.resize(text_bytes, ' ');
  bytes.append(subsystem_bytes, '\0');
  append_value(bytes, std::uint16_t{0x0100});
  append_value(bytes, std::uint16_t{'M' << 8 | 'I'});
  for (VectorColumn const& column : table.columns)
    bytes += matrix_element(column, rows, columns, static_cast<std::size_t>(table.grid_layers));
  write_vector_bytes(path, bytes, origin);
}

void write_vector_matlab(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  write_matlab_table(path, vector_table(field), origin);
}

}  // namespace gladstone::inline vectors
