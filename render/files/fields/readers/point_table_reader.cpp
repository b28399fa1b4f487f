#include "render/files/fields/readers/point_table_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/field_units.h"
#include "render/files/tecplot_zone.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Parses a number with a decimal point, or with a decimal comma: a comma within a field does not separate fields.
/// @return nullopt if the text is not a number
std::optional<double> parse_number(std::string_view field) {
  std::string number(field);
  if (number.find('.') == std::string::npos && std::count(number.begin(), number.end(), ',') == 1)
    std::replace(number.begin(), number.end(), ',', '.');
  std::string_view text = number;
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

/// Parses the name of a column and its unit, in brackets or as the ending of the name: "rho [kg/m^3]", "rho_kg_m3".
PointColumn named_column(std::string_view text) {
  std::size_t const open = text.find_last_of("[(");
  bool const bracketed = open != std::string_view::npos && open > 0 && (text.back() == ']' || text.back() == ')');
  if (!bracketed) return {trimmed(text), std::string(unit_suffix(text).unit), {}};
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

/// Reads the header of a table and its rows.
class PointTableReader {
 public:
  explicit PointTableReader(std::string const& path) : path_(path), file_(path, "a field file"), block_(path) {
    while (auto const line = file_.next()) {
      std::string_view const text = trim(*line);
      if (text.empty()) continue;
      if (!read_line(text)) break;
    }
    if (zone_.block) split_block();
    if (table_.line.empty())
      throw DataError(ErrorCode::missing_content, path,
                      "holds no row of numbers below a header that names the columns");
  }
  PointTable take() { return std::move(table_); }

 private:
  /// @return false at the end of the first zone
  bool read_line(std::string_view text) {
    std::vector<std::string> const fields = split_fields(text);
    bool const numbers = !fields.empty() && parse_number(fields.front());
    if (!numbers && table_.columns.empty()) {
      constexpr std::size_t most_header_lines = 200;
      if (header_.size() == most_header_lines)
        refuse(ErrorCode::wrong_format,
               fmt::format("no row of numbers in {} lines; is this a table of points?", most_header_lines));
      header_.emplace_back(text);
      return true;
    }
    if (text.front() == '#' || text.front() == '%') return true;
    if (lower_case(text.substr(0, 4)) == "zone") {
      table_.notes.push_back(
          {WarningCode::ignored, file_.place(), "another zone begins here; only the first one is read"});
      return false;
    }
    if (table_.columns.empty()) read_header();
    zone_.block ? add_block_values(fields) : add_row(fields);
    return true;
  }

  void read_header() {
    zone_ = parse_tecplot_zone(fmt::format("{}", fmt::join(header_, " ")));
    if (zone_.cell_centered)
      refuse(ErrorCode::unsupported,
             "the zone declares values in cells (CELLCENTERED); export all variables at the nodes");
    table_.columns = columns_of_header(header_);
    if (table_.columns.empty())
      refuse(ErrorCode::missing_content,
             "no header line names the columns; put their names first, such as x_mm,y_mm,z_mm,rho");
  }

  void add_row(std::vector<std::string> const& fields) {
    if (fields.size() != table_.columns.size()) {
      refuse(ErrorCode::syntax,
             fmt::format("{} fields, but the header names {} columns", fields.size(), table_.columns.size()));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      PointColumn& column = table_.columns[i];
      auto const value = parse_number(fields[i]);
      if (!value)
        refuse(ErrorCode::syntax, fmt::format("{} = \"{}\" is not a number", excerpt(column.name), excerpt(fields[i])));
      require_room(column.values, path_, "points");
      column.values.push_back(*value);
    }
    table_.line.push_back(file_.number());
  }

  /// Adds a line of a zone in BLOCK packing.
  void add_block_values(std::vector<std::string> const& fields) {
    for (std::string const& field : fields) {
      auto const value = parse_number(field);
      if (!value) refuse(ErrorCode::syntax, fmt::format("\"{}\" is not a number", excerpt(field)));
      block_.add(*value, file_.number());
    }
  }

  void split_block() {
    std::vector<std::vector<double>> values = block_.split(table_.columns.size(), zone_.points);
    table_.line = block_.lines(values.front().size());
    for (std::size_t i = 0; i < values.size(); ++i) table_.columns[i].values = std::move(values[i]);
  }

  [[noreturn]] void refuse(ErrorCode code, std::string const& why) const { throw DataError(code, file_.place(), why); }

  std::string path_;
  LineReader file_;
  std::vector<std::string> header_;
  TecplotZone zone_;
  BlockValues block_;  ///< values of a zone in BLOCK packing; empty for other packings
  PointTable table_;
};

}  // namespace

PointTable read_point_table(std::string const& path) { return PointTableReader(path).take(); }

}  // namespace gladstone::inline files
