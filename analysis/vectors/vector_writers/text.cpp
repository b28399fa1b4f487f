#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/files/output_file.h"

namespace gladstone::inline vectors {
namespace {

/// Appends one row per vector. Codes are written as integers, other numbers with 17 significant digits.
void append_rows(std::string& text, std::vector<VectorColumn> const& columns, std::size_t rows, char separator) {
  for (std::size_t i = 0; i < rows; ++i) {
    for (VectorColumn const& column : columns) {
      if (&column != columns.data()) text += separator;
      if (column.is_code) {
        fmt::format_to(std::back_inserter(text), "{}", static_cast<int>(column.values[i]));
      } else {
        fmt::format_to(std::back_inserter(text), "{:.17g}", column.values[i]);
      }
    }
    text += '\n';
  }
}

/// Replaces values that are not finite by 0.
/// @return column `unknown`: the sum of 2^k over the columns k, from 0, whose value was replaced
VectorColumn mark_unknown_values(std::vector<VectorColumn>& columns) {
  VectorColumn marks{"unknown", "1", "unknown values", true, {}};
  marks.values.resize(columns.empty() ? 0 : columns.front().values.size());
  double bit = 1;
  for (VectorColumn& column : columns) {
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      if (std::isfinite(column.values[i])) continue;
      column.values[i] = 0.0;
      marks.values[i] += bit;
    }
    bit *= 2;
  }
  return marks;
}

}  // namespace

void write_vector_bytes(std::string const& path, std::string const& bytes, FileOrigin const& origin) {
  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  origin.sources.check();
  file.commit();
}

void write_csv_table(std::string const& path, VectorTable const& table, FileOrigin const& origin) {
  std::string text;
  for (VectorColumn const& column : table.columns) text += (text.empty() ? "" : ",") + column.name;
  text += '\n';
  append_rows(text, table.columns, table.rows(), ',');
  write_vector_bytes(path, text, origin);
}

void write_tecplot_table(std::string const& path, VectorTable const& table, FileOrigin const& origin) {
  std::vector<VectorColumn> columns = table.columns;
  std::erase_if(columns, [](VectorColumn const& column) { return !column.is_known(); });
  columns.push_back(mark_unknown_values(columns));
  std::string names;
  for (VectorColumn const& column : columns) names += " \"" + column.name + '"';
  std::string text = fmt::format(
      "TITLE = \"gladstone vectors, {}; values are 0 where unknown contains 2^k, k = number of the variable from 0\"\n"
      "VARIABLES ={}",
      table.remark, names);
  bool const grid = table.grid_columns > 0;
  text += fmt::format("\nZONE T=\"vectors\", I={}, J={}, DATAPACKING=POINT\n",
                      grid ? static_cast<std::size_t>(table.grid_columns) : table.rows(), grid ? table.grid_rows : 1);
  append_rows(text, columns, table.rows(), ' ');
  write_vector_bytes(path, text, origin);
}

void write_vector_csv(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  write_csv_table(path, vector_table(field), origin);
}

void write_vector_tecplot(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  write_tecplot_table(path, vector_table(field), origin);
}

}  // namespace gladstone::inline vectors
