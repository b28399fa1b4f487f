#include "render/files/fields/readers/point_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/text.h"
#include "render/files/fields/readers/listed_arrays.h"
#include "render/files/text_file.h"

namespace gladstone {
namespace {

/// Column of a table: its name and unit, and its values.
struct PointColumn {
  std::string name, unit;
  std::vector<double> values;
};

/// Table of points as in the file.
struct PointTable {
  std::vector<PointColumn> columns;
  std::vector<std::size_t> line;  ///< line of each point, from 1
  std::vector<std::string> notes;
};

/// Parses a number; nullopt if the text is none.
std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Splits a line at the first of semicolon, tab and comma that occurs in it, else at blanks. Quotation marks enclose
/// fields, and are removed.
std::vector<std::string> split_fields(std::string_view line) {
  char separator = ' ';
  for (char const candidate : {';', '\t', ','}) {
    if (line.find(candidate) == std::string_view::npos) continue;
    separator = candidate;
    break;
  }
  std::vector<std::string> fields;
  std::string field;
  bool quoted = false, begun = false;
  auto const finish = [&] {
    if (separator != ' ' || begun) fields.push_back(trimmed(field));
    field.clear();
    begun = false;
  };
  for (char const c : line) {
    if (c == '"') {
      quoted = !quoted;
      begun = true;
    } else if (!quoted && (c == separator || (separator == ' ' && c == '\r'))) {
      finish();
    } else {
      field += c;
      begun = true;
    }
  }
  if (separator == ' ' || !trim(field).empty()) finish();
  return fields;
}

/// Splits a name of a column and its unit in brackets: "rho [kg/m^3]".
PointColumn named_column(std::string_view text) {
  std::size_t const open = text.find_last_of("[(");
  bool const bracketed = open != std::string_view::npos && open > 0 && (text.back() == ']' || text.back() == ')');
  if (!bracketed) return {trimmed(text), "", {}};
  return {trimmed(text.substr(0, open)), trimmed(text.substr(open + 1, text.size() - open - 2)), {}};
}

/// Returns the names of the columns in a header: Tecplot's VARIABLES, else its last line.
std::vector<PointColumn> columns_of_header(std::vector<std::string> const& header) {
  std::vector<PointColumn> columns;
  bool tecplot = false;
  for (std::string const& line : header) {
    std::string const lower = lower_case(line);
    bool const variables = lower.starts_with("variables");
    if (!variables && (!tecplot || lower.find('=') != std::string::npos || lower.starts_with("zone"))) {
      if (tecplot) break;
      continue;
    }
    tecplot = true;
    std::string names = variables ? line.substr(std::min(line.find('=') + 1, line.size())) : line;
    if (names.find('"') != std::string::npos) std::replace(names.begin(), names.end(), '\t', ' ');
    for (std::string const& name : split_fields(names)) columns.push_back(named_column(name));
  }
  if (tecplot || header.empty()) return columns;
  std::string_view names = header.back();
  while (names.starts_with('#') || names.starts_with('%')) names = trim(names.substr(1));
  for (std::string const& name : split_fields(names)) {
    // blanks separate a name from its unit as well: "x [mm] y [mm]"
    bool const unit_alone = !columns.empty() && (name.starts_with('[') || name.starts_with('(')) && name.size() > 2;
    if (unit_alone) {
      columns.back().unit = name.substr(1, name.size() - 2);
    } else {
      columns.push_back(named_column(name));
    }
  }
  return columns;
}

bool is_block_zone(std::vector<std::string> const& header) {
  std::string text;
  for (std::string const& line : header) text += lower_case(line);
  std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
  return text.find("datapacking=block") != std::string::npos || text.find("f=block") != std::string::npos;
}

/// Reads the header of a table and its rows.
class PointTableReader {
 public:
  explicit PointTableReader(std::string const& path) : path_(path), file_(path, "a field file") {
    while (auto const line = file_.next()) {
      std::string_view const text = trim(*line);
      if (text.empty()) continue;
      if (!read_line(text)) break;
    }
    if (table_.line.empty()) throw DataError(path, "holds no row of numbers below a header that names the columns");
  }
  PointTable take() { return std::move(table_); }

 private:
  /// @return false at the end of the first zone
  bool read_line(std::string_view text) {
    std::vector<std::string> const fields = split_fields(text);
    bool const numbers = !fields.empty() && parse_number(fields.front());
    if (!numbers && table_.line.empty()) {
      constexpr std::size_t most_header_lines = 200;
      if (header_.size() == most_header_lines)
        refuse(fmt::format("no row of numbers in {} lines; is this a table of points?", most_header_lines));
      header_.emplace_back(text);
      return true;
    }
    if (text.front() == '#' || text.front() == '%') return true;
    if (lower_case(text.substr(0, 4)) == "zone") {
      table_.notes.push_back(file_.place() + ": another zone begins here; only the first one is read");
      return false;
    }
    if (table_.line.empty()) read_header();
    add_row(fields);
    return true;
  }

  void read_header() {
    if (is_block_zone(header_)) refuse("the zone is in BLOCK packing; export it in POINT packing");
    table_.columns = columns_of_header(header_);
    if (table_.columns.empty())
      refuse("no header line names the columns; put their names first, such as x_mm,y_mm,z_mm,rho");
  }

  void add_row(std::vector<std::string> const& fields) {
    if (fields.size() != table_.columns.size()) {
      refuse(fmt::format("{} fields, but the header names {} columns", fields.size(), table_.columns.size()));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      PointColumn& column = table_.columns[i];
      auto const value = parse_number(fields[i]);
      if (!value) refuse(fmt::format("{} = \"{}\" is not a number", excerpt(column.name), excerpt(fields[i])));
      require_room(column.values, path_, "points");
      column.values.push_back(*value);
    }
    table_.line.push_back(file_.number());
  }

  [[noreturn]] void refuse(std::string const& why) const { throw DataError(file_.place(), why); }

  std::string path_;
  LineReader file_;
  std::vector<std::string> header_;
  PointTable table_;
};

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
        throw DataError(fmt::format("{}:{}", path, table.line[i]),
                        fmt::format("{} is not finite; correct the coordinate", excerpt(column.name)));
      }
      axes.push_back({&column, letter, distinct_levels(column.values)});
      break;
    }
  }
  if (axes.size() >= 2) return axes;
  std::vector<std::string> names;
  for (PointColumn const& column : table.columns) names.push_back(column.name);
  throw DataError(path, fmt::format("names no coordinates of points (columns x, y and z, or x_mm ...; the columns are "
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
  if (nodes > 1e18) throw DataError(path, "holds points that do not lie on a regular grid; resample them to one");
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
      throw DataError(fmt::format("{}:{}", path, table.line[places[i].second]),
                      fmt::format("the point {} is also in line {}; keep one of them", node_text(axes, places[i].first),
                                  table.line[places[i - 1].second]));
    }
    throw DataError(path,
                    fmt::format("lacks the point {}: {} points do not fill the grid of {:.0f}; add it, or resample "
                                "the points to a regular grid",
                                node_text(axes, i), places.size(), nodes));
  }
  if (static_cast<double>(places.size()) < nodes) {
    throw DataError(path,
                    fmt::format("lacks the point {}: {} points do not fill the grid of {:.0f}; add it, or resample "
                                "the points to a regular grid",
                                node_text(axes, places.size()), places.size(), nodes));
  }
  return rows;
}

/// Returns the array of some columns on the grid; the components of several columns are its last axis.
ListedArray grid_array(std::string const& name, std::vector<std::shared_ptr<PointColumn const>> const& columns,
                       std::vector<std::size_t> shape, std::shared_ptr<std::vector<std::size_t> const> const& rows) {
  if (columns.size() > 1) shape.push_back(columns.size());
  ReadValues const read = [columns, rows](std::size_t first, std::span<double> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      std::size_t const at = first + i;
      out[i] = columns[at % columns.size()]->values[(*rows)[at / columns.size()]];
    }
  };
  ListedArray array{name, std::move(shape), std::numeric_limits<double>::digits, read};
  array.units = columns.front()->unit;
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

/// Names of the columns of the components of a velocity.
using ComponentNames = std::array<std::string_view, 3>;
constexpr std::array velocity_columns{ComponentNames{"u", "v", "w"}, ComponentNames{"vx", "vy", "vz"},
                                      ComponentNames{"ux", "uy", "uz"}};

/// Returns the columns of these names; empty if one is missing.
std::vector<std::shared_ptr<PointColumn const>> find_columns(
    std::vector<std::shared_ptr<PointColumn const>> const& columns, ComponentNames const& names) {
  std::vector<std::shared_ptr<PointColumn const>> found;
  for (std::string_view const name : names) {
    auto const one = std::find_if(columns.begin(), columns.end(),
                                  [&](auto const& column) { return lower_case(column->name) == name; });
    if (one == columns.end()) return {};
    found.push_back(*one);
  }
  return found;
}

}  // namespace

std::unique_ptr<CheckedSource> open_point_table(std::string const& path, FieldSelection const& selection) {
  PointTable table = PointTableReader(path).take();
  std::vector<PointAxis> const axes = axes_of_table(table, path);
  auto const rows = std::make_shared<std::vector<std::size_t> const>(rows_of_nodes(table, axes, path));
  std::vector<ListedArray> arrays;
  std::vector<std::size_t> shape;
  for (PointAxis const& axis : axes) {
    arrays.push_back(coordinate_array(axis));
    shape.push_back(axis.levels.size());
  }
  std::vector<std::shared_ptr<PointColumn const>> columns;
  for (PointColumn& column : table.columns) {
    if (coordinate_name(column.name)) continue;
    columns.push_back(std::make_shared<PointColumn const>(std::move(column)));
    arrays.push_back(grid_array(columns.back()->name, {columns.back()}, shape, rows));
  }
  for (auto const& names : velocity_columns) {
    if (selection.values == 1) break;
    auto const components = find_columns(columns, names);
    if (!components.empty()) arrays.push_back(grid_array("velocity", components, shape, rows));
  }
  return open_array_field(
      std::make_unique<ListedArrays>(path, std::move(arrays), std::vector<OtherEntry>{}, std::move(table.notes)), path,
      selection);
}

}  // namespace gladstone
