#include "render/files/fields/readers/point_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/field_units.h"
#include "render/files/fields/readers/array_coordinates.h"
#include "render/files/fields/readers/listed_arrays.h"
#include "render/files/fields/readers/point_table_reader.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Coordinate of the points along a world axis, and its distinct values in ascending order.
struct PointAxis {
  PointColumn const* column;
  char letter;
  std::vector<double> levels;

  std::size_t level(std::size_t point) const {
    // the level of a point is at most its coordinate, since equal coordinates share the smallest one
    auto const above = std::upper_bound(levels.begin(), levels.end(), column->values[point]);
    return static_cast<std::size_t>(above - levels.begin()) - 1;
  }
};

/// Finds the distinct values of a coordinate. Values within a millionth of the extent, or within the rounding of single
/// precision, are equal.
std::vector<double> distinct_levels(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double const largest = std::max(std::abs(values.front()), std::abs(values.back()));
  double const tolerance =
      std::max(1e-6 * (values.back() - values.front()), 4.0 * std::numeric_limits<float>::epsilon() * largest);
  std::vector<double> levels;
  for (double const value : values) {
    if (levels.empty() || value - levels.back() > tolerance) levels.push_back(value);
  }
  return levels;
}

/// Returns the axes of a table, z before y before x.
std::vector<PointAxis> axes_of_table(PointTable const& table, std::string const& path) {
  std::vector<PointAxis> axes;
  for (char const letter : {'z', 'y', 'x'}) {
    for (PointColumn const& column : table.columns) {
      auto const named = coordinate_name(column.name);
      if (!named || named->axis != letter) continue;
      for (std::size_t i = 0; i < column.values.size(); ++i) {
        if (std::isfinite(column.values[i])) continue;
        throw DataError(ErrorCode::invalid_value, fmt::format("{}:{}", path, table.line[i]),
                        fmt::format("{} is not finite; correct the coordinate", excerpt(column.name)));
      }
      axes.push_back({&column, letter, distinct_levels(column.values)});
      break;
    }
  }
  if (axes.size() >= 2) return axes;
  std::vector<std::string> names;
  for (PointColumn const& column : table.columns) names.push_back(column.name);
  throw DataError(ErrorCode::missing_content, path,
                  fmt::format("names no coordinates of points (columns x, y and z, or x_mm ...; the columns are "
                              "{}); name them in the header",
                              excerpt(fmt::format("{}", fmt::join(names, ", ")), 200)));
}

/// Describes the node of a grid: "x = 1, y = 2, z = 0".
std::string node_text(std::vector<PointAxis> const& axes, std::uint64_t node) {
  std::string text;
  for (std::size_t i = axes.size(); i-- > 0; node /= axes[i].levels.size()) {
    text += fmt::format("{}{} = {:.9g}", text.empty() ? "" : ", ", axes[i].column->name,
                        axes[i].levels[node % axes[i].levels.size()]);
  }
  return text;
}

/// Returns the row of the table for each node of the grid, x fastest.
/// @throws DataError that names the first node without a point, or with two
std::vector<std::size_t> rows_of_nodes(PointTable const& table, std::vector<PointAxis> const& axes,
                                       std::string const& path) {
  double nodes = 1;
  for (PointAxis const& axis : axes) nodes *= static_cast<double>(axis.levels.size());
  if (nodes > 1e18)
    throw DataError(ErrorCode::unsupported, path,
                    "contains points that do not form a regular grid; resample them to such a grid");
  std::vector<std::pair<std::uint64_t, std::size_t>> places(table.line.size());
  for (std::size_t point = 0; point < places.size(); ++point) {
    std::uint64_t node = 0;
    for (PointAxis const& axis : axes) node = node * axis.levels.size() + axis.level(point);
    places[point] = {node, point};
  }
  throw_if_interrupted();
  std::sort(places.begin(), places.end());
  std::vector<std::size_t> rows(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    rows[i] = places[i].second;
    if (places[i].first == i) continue;
    if (places[i].first < i) {
      throw DataError(ErrorCode::invalid_value, fmt::format("{}:{}", path, table.line[places[i].second]),
                      fmt::format("the point {} is also in line {}; keep one of them", node_text(axes, places[i].first),
                                  table.line[places[i - 1].second]));
    }
    throw DataError(
        ErrorCode::missing_content, path,
        fmt::format("lacks the point {}: {} points do not fill the grid of {:.0f} nodes; add it, or resample "
                    "the points to a regular grid",
                    node_text(axes, i), places.size(), nodes));
  }
  if (static_cast<double>(places.size()) < nodes) {
    throw DataError(
        ErrorCode::missing_content, path,
        fmt::format("lacks the point {}: {} points do not fill the grid of {:.0f} nodes; add it, or resample "
                    "the points to a regular grid",
                    node_text(axes, places.size()), places.size(), nodes));
  }
  return rows;
}

/// Returns the array of a column on the grid.
ListedArray grid_array(PointColumn column, std::vector<std::size_t> const& shape,
                       std::shared_ptr<std::vector<std::size_t> const> const& rows) {
  auto const values = std::make_shared<std::vector<double> const>(std::move(column.values));
  ReadValues const read = [values, rows](std::size_t first, std::span<double> out) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (*values)[(*rows)[first + i]];
  };
  ListedArray array{column.name, shape, std::numeric_limits<double>::digits, read};
  array.units = column.unit;
  return array;
}

ListedArray coordinate_array(PointAxis const& axis) {
  ReadValues const read = [levels = axis.levels](std::size_t first, std::span<double> out) {
    std::copy_n(levels.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
  };
  ListedArray array{std::string(1, axis.letter), {axis.levels.size()}, std::numeric_limits<double>::digits, read};
  auto const named = coordinate_name(axis.column->name);
  array.units = !axis.column->unit.empty() || !named ? axis.column->unit : named->unit;
  return array;
}

}  // namespace

std::unique_ptr<CheckedSource> open_point_table(std::string const& path, FieldSelection const& selection) {
  PointTable table = read_point_table(path);
  std::vector<PointAxis> const axes = axes_of_table(table, path);
  auto const rows = std::make_shared<std::vector<std::size_t> const>(rows_of_nodes(table, axes, path));
  std::vector<ListedArray> arrays;
  std::vector<std::size_t> shape;
  for (PointAxis const& axis : axes) {
    arrays.push_back(coordinate_array(axis));
    shape.push_back(axis.levels.size());
  }
  for (PointColumn& column : table.columns) {
    if (!coordinate_name(column.name)) arrays.push_back(grid_array(std::move(column), shape, rows));
  }
  return open_array_field(
      std::make_unique<ListedArrays>(path, std::move(arrays), std::vector<OtherEntry>{}, std::move(table.notes)), path,
      selection);
}

}  // namespace gladstone::inline files
