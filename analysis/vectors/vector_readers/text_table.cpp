#include "analysis/vectors/vector_readers/text_table.h"

#include <fmt/format.h>

#include <optional>

#include "analysis/vectors/vector_readers/text_rows.h"
#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/text_file.h"

namespace gladstone::detail {
namespace {

constexpr std::size_t most_lines_before_numbers = 1000;

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
  throw DataError(fmt::format("{}:{}", path, header_line),
                  fmt::format("no column {} (the columns are {}); name it in the header line", wanted,
                              excerpt(fmt::format("{}", fmt::join(names, ", ")), 200)));
}

std::vector<double> const& TextTable::column(std::initializer_list<std::string_view> any_of) const {
  if (auto const found = find(any_of)) return values[*found];
  refuse_missing(*any_of.begin());
}

TextTable read_text_table(std::string const& path) {
  LineReader file(path, "a file of vectors");
  TextTable table;
  table.path = path;
  auto const fail = [&](std::size_t at, std::string const& message) {
    throw DataError(fmt::format("{}:{}", path, at), message);
  };

  std::string header;
  DeclaredVectors declared;
  RowFormat format;
  auto const name_columns = [&](std::size_t at, std::string_view row) {
    std::string whole;
    for (std::string const& line : table.preamble) whole += line + ' ';
    whole += header;
    table.names = tecplot_variables(whole);
    table.tecplot = !table.names.empty();
    if (table.tecplot && is_block_packed(whole))
      fail(table.header_line, "is Tecplot's BLOCK packing (values variable by variable); export it in POINT packing");
    std::optional<DavisHeader> const davis = parse_davis_header(header);
    table.davis = davis.has_value();
    if (davis && !davis->planar)
      fail(
          table.header_line,
          "is DaVis' text export of other data than 2D-vector (columns x, y, u, v); export two components, or as .dat");
    if (table.header_line == 0) {
      table.has_header = false;
      if (!lower_case(path).ends_with(".jvc"))
        fail(at, "no header line (numbers from the start); put the names of the columns first, such as x,y,u,v");
      table.names = {"x", "y", "u", "v"};
      if (split(row, row_format(row, 5).separator).size() > 4) table.names.emplace_back("quality");
    } else if (davis) {
      table.names = davis->names;
    } else if (!table.tecplot) {
      table.names = column_names(header);
    }
    table.values.resize(table.names.size());
    format = row_format(row, table.names.size());
  };
  while (auto const line = file.next()) {
    std::size_t const at = file.number();
    std::string_view text = *line;
    if (text.find('\0') != std::string_view::npos)
      fail(at,
           "contains NUL bytes, as binary files do; vectors are read from text files and from vectors.h5 of gladstone");
    text = trim(text);
    if (text.empty()) continue;

    // Skip the lines before the first row of numbers; the last of them is the header.
    if (format.separator == 0 && !number(split(text, detect_separator(text)).front(), ',')) {
      if (at > most_lines_before_numbers) {
        fail(at, fmt::format("no row of numbers in {} lines; is this a table of vectors?", most_lines_before_numbers));
      }
      if (table.header_line != 0) table.preamble.push_back(header);
      header = text;
      declared.add(text, at);
      table.header_line = at;
      continue;
    }
    if (format.separator == 0) name_columns(at, text);
    if (text.front() == '#') continue;
    if (table.tecplot && lower_case(text.substr(0, 4)) == "zone") {
      table.warnings.push_back(fmt::format("{}:{}: another zone begins here; only the first one is read", path, at));
      break;
    }

    std::vector<std::string_view> const fields = fields_of(text, format, table.names.size());
    if (fields.size() != table.names.size()) {
      std::string const commas =
          has_ambiguous_commas(text, table.names.size())
              ? "; commas may both separate the fields and mark decimals: export decimal points, "
                "or semicolons between the fields"
              : "";
      fail(at, fmt::format("{} fields, but the header names {} columns ({}){}", fields.size(), table.names.size(),
                           excerpt(fmt::format("{}", fmt::join(table.names, ", ")), 200), commas));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::optional<double> const value = number(fields[i], format.decimal);
      if (!value) fail(at, fmt::format("{} = \"{}\" is not a number", excerpt(table.names[i]), excerpt(fields[i])));
      table.values[i].push_back(*value);
    }
    require_room(table.line, path, "vectors");
    table.line.push_back(at);
  }
  if (table.header_line == 0 && table.has_header) throw DataError(path + ":1", "the file is empty");
  if (table.line.empty()) fail(table.header_line, "no row of numbers follows the header");
  if (declared.count() && *declared.count() != static_cast<double>(table.rows())) {
    table.complete = false;
    table.warnings.push_back(
        fmt::format("{}:{}: the header declares {} vectors, but the file contains {} (truncated, or written with "
                    "another header); export it again",
                    path, declared.line(), *declared.count(), table.rows()));
  }
  return table;
}

}  // namespace gladstone::detail
