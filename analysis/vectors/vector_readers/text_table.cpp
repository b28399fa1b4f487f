#include "analysis/vectors/vector_readers/text_table.h"

#include <fmt/format.h>

#include <optional>

#include "analysis/vectors/vector_readers/text_rows.h"
#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/tecplot_zone.h"
#include "render/files/text_file.h"

namespace gladstone::inline vectors {
namespace {

constexpr std::size_t most_lines_before_numbers = 1000;

/// Reads a table line by line: lines of the header, then rows of numbers.
class TableReader {
 public:
  explicit TableReader(std::string const& path) : file_(path, "a file of vectors"), block_(path) { table_.path = path; }

  TextTable read() && {
    while (auto const line = file_.next()) {
      if (line->find('\0') != std::string_view::npos)
        fail(ErrorCode::wrong_format, file_.number(),
             "contains NUL bytes, as binary files do; give a text file, or one of the other formats of gladstone "
             "convert with its ending (.h5, .nc, .mat, .vti, .vtp)");
      std::string_view const text = trim(*line);
      if (text.empty() || read_header_line(text)) continue;
      if (format_.separator == 0) name_columns(text);
      if (text.front() == '#') continue;
      if (table_.tecplot && lower_case(text.substr(0, 4)) == "zone") {
        table_.warnings.push_back(
            {WarningCode::ignored, file_.place(), "another zone begins here; only the first one is read"});
        break;
      }
      zone_.block ? add_block_values(text) : add_row(text);
    }
    if (zone_.block) split_block();
    check_rows();
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(ErrorCode code, std::size_t line, std::string const& message) const {
    throw DataError(code, fmt::format("{}:{}", table_.path, line), message);
  }

  /// Stores a line before the first row of numbers; the last of these lines is the header. @return false if the line is
  /// not one of them
  bool read_header_line(std::string_view text) {
    if (format_.separator != 0 || number(split(text, detect_separator(text)).front(), ',')) return false;
    std::size_t const at = file_.number();
    if (at > most_lines_before_numbers) {
      fail(ErrorCode::wrong_format, at,
           fmt::format("no row of numbers in {} lines; is this a table of vectors?", most_lines_before_numbers));
    }
    if (table_.header_line != 0) table_.preamble.push_back(header_);
    header_ = text;
    declared_.add(text, at);
    table_.header_line = at;
    return true;
  }

  /// Determines the names of the columns and the format of the rows. @param row  first row of numbers
  void name_columns(std::string_view row) {
    std::string whole;
    for (std::string const& line : table_.preamble) whole += line + ' ';
    whole += header_;
    table_.names = tecplot_variables(whole);
    table_.tecplot = !table_.names.empty();
    if (table_.tecplot) zone_ = parse_tecplot_zone(whole);
    if (zone_.cell_centered)
      fail(ErrorCode::unsupported, table_.header_line,
           "declares values in cells (CELLCENTERED); export all variables at the nodes");
    std::optional<DavisHeader> const davis = parse_davis_header(header_);
    table_.davis = davis.has_value();
    if (davis && !davis->planar)
      fail(
          ErrorCode::unsupported, table_.header_line,
          "is DaVis' text export of other data than 2D-vector (columns x, y, u, v); export two components, or as .dat");
    if (table_.header_line == 0) {
      name_columns_of_jvc(row);
    } else if (davis) {
      table_.names = davis->names;
    } else if (!table_.tecplot) {
      table_.names = column_names(header_);
    }
    table_.values.resize(table_.names.size());
    format_ = zone_.block ? RowFormat{detect_separator(row), '.'} : row_format(row, table_.names.size());
  }

  /// Names the columns of a file without header, which must be one of JPIV (.jvc). @param row  its first row
  void name_columns_of_jvc(std::string_view row) {
    table_.has_header = false;
    if (!lower_case(table_.path).ends_with(".jvc"))
      fail(ErrorCode::missing_content, file_.number(),
           "no header line (numbers from the start); put the names of the columns first, such as x,y,u,v");
    table_.names = {"x", "y", "u", "v"};
    if (split(row, row_format(row, 5).separator).size() > 4) table_.names.emplace_back("quality");
  }

  void add_row(std::string_view text) {
    std::size_t const at = file_.number();
    std::vector<std::string_view> const fields = fields_of(text, format_, table_.names.size());
    if (fields.size() != table_.names.size()) refuse_fields(text, fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::optional<double> const value = number(fields[i], format_.decimal);
      if (!value)
        fail(ErrorCode::syntax, at,
             fmt::format("{} = \"{}\" is not a number", excerpt(table_.names[i]), excerpt(fields[i])));
      table_.values[i].push_back(*value);
    }
    require_room(table_.line, table_.path, "vectors");
    table_.line.push_back(at);
  }

  /// Adds the values of a line to a zone in BLOCK packing.
  void add_block_values(std::string_view text) {
    for (std::string_view const field : split(text, format_.separator)) {
      std::optional<double> const value = number(field);
      if (!value) fail(ErrorCode::syntax, file_.number(), fmt::format("\"{}\" is not a number", excerpt(field)));
      block_.add(*value, file_.number());
    }
  }

  void split_block() {
    table_.values = block_.split(table_.names.size(), zone_.points);
    table_.line = block_.lines(table_.values.front().size());
  }

  [[noreturn]] void refuse_fields(std::string_view text, std::size_t count) const {
    std::string const commas = has_ambiguous_commas(text, table_.names.size())
                                   ? "; commas may both separate the fields and mark decimals: export decimal points, "
                                     "or semicolons between the fields"
                                   : "";
    fail(ErrorCode::syntax, file_.number(),
         fmt::format("{} fields, but the header names {} columns ({}){}", count, table_.names.size(),
                     excerpt(fmt::format("{}", fmt::join(table_.names, ", ")), 200), commas));
  }

  /// Checks that there are rows, and warns if their number differs from that declared in the header.
  void check_rows() {
    if (table_.header_line == 0 && table_.has_header)
      throw DataError(ErrorCode::missing_content, table_.path + ":1", "the file is empty");
    if (table_.line.empty())
      fail(ErrorCode::missing_content, table_.header_line, "no row of numbers follows the header");
    if (!declared_.count() || *declared_.count() == static_cast<double>(table_.rows())) return;
    table_.complete = false;
    table_.warnings.push_back({WarningCode::incomplete, fmt::format("{}:{}", table_.path, declared_.line()),
                               fmt::format("the header declares {} vectors, but the file contains {} (truncated, or "
                                           "written with another header); export it again",
                                           *declared_.count(), table_.rows())});
  }

  LineReader file_;
  TextTable table_;
  std::string header_;  ///< last line before the rows of numbers
  DeclaredVectors declared_;
  RowFormat format_;  ///< format of the rows; has no separator until the first row of numbers
  TecplotZone zone_;
  BlockValues block_;  ///< values of a zone in BLOCK packing; empty for other packings
};

}  // namespace

std::optional<std::size_t> TextTable::find_quantity(std::initializer_list<std::string_view> any_of) const {
  std::optional<std::size_t> best;
  int best_rank = 0;
  for (std::string_view const wanted : any_of) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      ColumnName const name = parse_column_name(names[i]);
      if (name.quantity != wanted) continue;
      int const rank = name.unit.empty() ? 1 : is_pixel_unit(name.unit) ? 3 : 2;
      if (rank > best_rank) {
        best = i;
        best_rank = rank;
      }
    }
  }
  return best;
}

std::size_t TextTable::quantity(std::initializer_list<std::string_view> any_of) const {
  if (auto const found = find_quantity(any_of)) return *found;
  refuse_missing(*any_of.begin());
}

std::optional<std::size_t> TextTable::find(std::initializer_list<std::string_view> any_of) const {
  for (std::string_view const wanted : any_of) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (lower_case(names[i]) == wanted) return i;
    }
  }
  return std::nullopt;
}

void TextTable::refuse_missing(std::string_view wanted) const {
  throw DataError(ErrorCode::missing_content, fmt::format("{}:{}", path, header_line),
                  fmt::format("no column {} (the columns are {}); name it in the header line", wanted,
                              excerpt(fmt::format("{}", fmt::join(names, ", ")), 200)));
}

std::vector<double> const& TextTable::column(std::initializer_list<std::string_view> any_of) const {
  if (auto const found = find(any_of)) return values[*found];
  refuse_missing(*any_of.begin());
}

TextTable read_text_table(std::string const& path) { return TableReader(path).read(); }

}  // namespace gladstone::inline vectors
