#include "analysis/vectors/grid_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <span>

#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"
#include "render/files/hdf5_axes.h"

namespace gladstone::inline vectors {
namespace {

/// Returns the table with additional first columns x_mm, y_mm (and z_mm), the positions of the nodes.
VectorTable with_positions(GridTable const& grid) {
  std::vector<std::size_t> const shape = grid.shape();
  VectorTable table;
  table.grid_columns = static_cast<int>(shape.back());
  table.grid_rows = static_cast<int>(shape[shape.size() - 2]);
  table.grid_layers = shape.size() == 3 ? static_cast<int>(shape.front()) : 1;
  table.content = "density";
  table.remark = "mm, y upwards";
  std::size_t stride = 1;
  for (std::size_t k = grid.axes.size(); k-- > 0;) {
    TableAxis const& axis = grid.axes[k];
    std::vector<double> places(grid.nodes());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = axis.place_mm[i / stride % shape[k]];
    table.columns.push_back(number_column(axis.name + "_mm", "mm", axis.description, std::move(places)));
    stride *= shape[k];
  }
  table.columns.insert(table.columns.end(), grid.columns.begin(), grid.columns.end());
  return table;
}

/// Returns a unit as CF Conventions write it: "kg m-3" of "kg/m^3".
std::string cf_unit(std::string const& unit) {
  std::string text;
  for (char const c : unit) {
    if (c == '/') text += ' ';
    if (c == '^') text += '-';
    if (c != '/' && c != '^') text += c;
  }
  return text;
}

/// Returns the name of a column without its unit: "density" of "density_kg_m3" in "kg/m^3".
std::string name_without_unit(VectorColumn const& column) {
  std::string ending = '_' + column.units;
  std::replace(ending.begin(), ending.end(), '/', '_');
  std::erase(ending, '^');
  return column.name.ends_with(ending) ? column.name.substr(0, column.name.size() - ending.size()) : column.name;
}

void write_netcdf(std::string const& path, GridTable const& grid, FileOrigin const& origin) {
  Hdf5Writer file(path, origin);
  Hdf5Axes axes(file);
  std::vector<std::string> scales;
  std::string order;
  for (TableAxis const& axis : grid.axes) {
    file.write('/' + axis.name, std::span<double const>(axis.place_mm), {axis.place_mm.size()}, "mm", axis.description,
               axis.name);
    scales.push_back('/' + axis.name);
    order += (order.empty() ? "" : ", ") + axis.name;
  }
  for (VectorColumn const& column : grid.columns) {
    std::string const name = '/' + name_without_unit(column);
    file.write(name, std::span<double const>(column.values), grid.shape(), cf_unit(column.units), column.description,
               order);
    file.attribute(name, "long_name", column.description);
    axes.name(name, scales);
  }
  axes.attach();
  file.close();
}

/// Writer of a format, selected by the extension of the file. A new format requires one more row.
struct GridWriter {
  char const* extension;
  void (*write)(std::string const& path, GridTable const& grid, FileOrigin const& origin);
};
constexpr std::array grid_writers{
    GridWriter{".csv", [](auto const& path, auto const& grid,
                          auto const& origin) { write_csv_table(path, with_positions(grid), origin); }},
    GridWriter{".nc", write_netcdf},
    GridWriter{".mat", [](auto const& path, auto const& grid,
                          auto const& origin) { write_matlab_table(path, with_positions(grid), origin); }},
    GridWriter{".vti",
               [](auto const& path, auto const& grid, auto const& origin) {
                 std::array<std::vector<double>, 3> places{std::vector<double>{0}, {0}, {0}};
                 for (std::size_t k = 0; k < grid.axes.size(); ++k) {
                   places[k] = grid.axes[grid.axes.size() - 1 - k].place_mm;
                 }
                 write_vti_scalars(path, grid.columns, places, "mm, y upwards", origin);
               }},
};

}  // namespace

std::vector<std::size_t> GridTable::shape() const {
  std::vector<std::size_t> shape;
  for (TableAxis const& axis : axes) shape.push_back(axis.place_mm.size());
  return shape;
}

std::size_t GridTable::nodes() const {
  std::size_t count = 1;
  for (TableAxis const& axis : axes) count *= axis.place_mm.size();
  return count;
}

std::vector<std::string> grid_table_extensions() {
  std::vector<std::string> names;
  for (GridWriter const& writer : grid_writers) names.emplace_back(writer.extension);
  return names;
}

void write_grid_table(std::string const& path, GridTable const& table, FileOrigin const& origin) {
  auto const* const writer = std::find_if(grid_writers.begin(), grid_writers.end(),
                                          [&](auto const& one) { return path.ends_with(one.extension); });
  if (writer == grid_writers.end()) {
    throw OutputError(
        path, fmt::format("must end in one of {}, which selects the format", fmt::join(grid_table_extensions(), ", ")));
  }
  writer->write(path, table, origin);
}

}  // namespace gladstone::inline vectors
