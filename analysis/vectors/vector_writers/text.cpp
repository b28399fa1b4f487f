#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/files/output_file.h"

namespace gladstone::detail {
namespace {

/// Appends one row per vector, codes as integers and other numbers with 17 significant digits.
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
  std::string names;
  bool any_unknown = false;
  for (VectorColumn& column : columns) {
    names += " \"" + column.name + '"';
    for (double& value : column.values) {
      if (std::isfinite(value)) continue;
      value = 0.0;
      any_unknown = true;
    }
  }
  std::string text = fmt::format("TITLE = \"gladstone vectors, {}{}\"\nVARIABLES ={}", table.remark,
                                 any_unknown ? "; unknown values are 0" : "", names);
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

}  // namespace gladstone::detail
