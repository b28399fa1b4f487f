#include <fmt/format.h>

#include <iterator>
#include <span>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"

namespace gladstone::inline vectors {
namespace {

void write_column(Hdf5Writer& file, std::string const& dataset, VectorColumn const& column,
                  std::vector<std::size_t> const& shape, std::string const& axes) {
  if (column.is_code) {
    std::vector<std::int64_t> const codes(column.values.begin(), column.values.end());
    file.write(dataset, std::span<std::int64_t const>(codes), shape, column.units, column.description, axes);
  } else {
    file.write(dataset, std::span<double const>(column.values), shape, column.units, column.description, axes);
  }
}

void write_scale_px(Hdf5Writer& file, std::string const& dataset, std::vector<double> const& places,
                    std::string const& description, std::string const& axis) {
  file.write(dataset, std::span<double const>(places), {places.size()}, "px", description, axis);
}

/// Writes the group /grid: the most used quantities in rows and columns, with their coordinates.
void write_grid(Hdf5Writer& file, std::string const& path, DisplacementField const& field,
                std::vector<VectorColumn> const& columns, std::vector<ScaledDataset>& scaled) {
  VectorGrid const grid = require_vector_grid(field, path, "a grid");
  write_scale_px(file, "/grid/x_px", grid.x, "columns of the window centres", "column");
  write_scale_px(file, "/grid/y_px", grid.y, "rows of the window centres, downwards", "row");
  for (char const* const name : {"u_px", "v_px", "sigma_u_px", "sigma_v_px", "status"}) {
    std::string const dataset = fmt::format("/grid/{}", name);
    write_column(file, dataset, column_named(columns, name), {grid.y.size(), grid.x.size()}, "row, column");
    scaled.push_back({dataset, {"/grid/y_px", "/grid/x_px"}});
  }
}

}  // namespace

void write_vector_hdf5(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  write_vector_columns(path, field, {}, origin);
}

void write_vector_columns(std::string const& path, DisplacementField const& field, std::vector<VectorColumn> more,
                          FileOrigin const& origin) {
  Hdf5Writer file(path, origin);
  std::vector<VectorColumn> columns = vector_columns(field);
  columns.push_back(failed_test_column(field));
  columns.insert(columns.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  std::vector<std::int64_t> numbers(field.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::int64_t>(i);
  file.write("/vector", std::span<std::int64_t const>(numbers), {numbers.size()}, "1", "number of the vector, from 0",
             "vector");
  std::vector<ScaledDataset> scaled;
  for (VectorColumn const& column : columns) {
    write_column(file, '/' + column.name, column, {field.size()}, "vector");
    scaled.push_back({'/' + column.name, {"/vector"}});
  }
  if (field.columns > 0) write_grid(file, path, field, columns, scaled);
  file.attach_scales(scaled);
  if (field.verdict != PairVerdict{}) {
    file.attribute("/", "verdict", verdict_text(field.verdict));
    file.attribute("/", "verdict_code", std::string(verdict_code(field.verdict.kind)));
    file.attribute("/", "verdict_number", field.verdict.number);
  }
  if (!field.uncertainty_method.empty()) {
    file.attribute("/", "uncertainty_method", field.uncertainty_method);
    file.attribute("/", "uncertainty_key", field.uncertainty_key);
  }
  file.attribute("/", "warnings", fmt::format("{}", fmt::join(to_strings(field.warnings), "\n")));
  std::vector<std::string> codes;
  for (Warning const& warning : field.warnings)
    codes.push_back(fmt::format("{} {}", warning_code_name(warning.code), warning.place));
  file.attribute("/", "warning_codes", fmt::format("{}", fmt::join(codes, "\n")));
  if (field.columns > 0) {
    file.attribute("/", "grid_columns", std::int64_t{field.columns});
    file.attribute("/", "grid_rows", std::int64_t{field.rows});
  }
  file.close();
}

}  // namespace gladstone::inline vectors
