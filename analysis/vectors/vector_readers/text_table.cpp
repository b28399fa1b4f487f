#include "analysis/vectors/vector_readers/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>

#include "render/base/error.h"
#include "render/base/text_file.h"

namespace gladstone::detail {
namespace {

constexpr std::string_view blanks = " \t\r";
constexpr std::size_t most_lines_before_numbers = 1000;

std::string_view trimmed(std::string_view text) {
  auto const begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// Returns the separator of a line: the first of semicolon, tab and comma (possibly a decimal comma) that occurs in it,
/// else a blank.
char separator_of(std::string_view line) {
  for (char const candidate : {';', '\t', ','}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  return ' ';
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator == ' ') {
    for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
      std::size_t const end = std::min(line.find_first_of(blanks, at), line.size());
      fields.push_back(line.substr(at, end - at));
      at = line.find_first_not_of(blanks, end);
    }
    return fields;
  }
  for (std::size_t at = 0;;) {
    std::size_t const end = std::min(line.find(separator, at), line.size());
    fields.push_back(trimmed(line.substr(at, end - at)));
    if (end == line.size()) return fields;
    at = end + 1;
  }
}

/// Number format of a row.
struct RowFormat {
  char separator = 0;  ///< 0: not yet determined
  char decimal = '.';
};

std::optional<double> number(std::string_view text, char decimal = '.') {
  if (decimal == ',' && text.find(',') != std::string_view::npos) {
    std::string point(text);
    std::replace(point.begin(), point.end(), ',', '.');
    return number(point);
  }
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // outside of the range of double: 1e400 is infinite, 1e-400 is 0
    bool const tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
    value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return text.front() == '-' ? -value : value;
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// Splits a row into fields; ignores a separator at the end of the line.
std::vector<std::string_view> fields_of(std::string_view line, RowFormat format, std::size_t columns) {
  std::vector<std::string_view> fields = split(line, format.separator);
  if (fields.size() == columns + 1 && fields.back().empty()) fields.pop_back();
  return fields;
}

/// Returns the format in which a row has as many numbers as there are columns; if there is none, the separator of the
/// line.
RowFormat row_format(std::string_view line, std::size_t columns) {
  constexpr std::array<RowFormat, 7> formats{
      {{';', '.'}, {';', ','}, {',', '.'}, {'\t', '.'}, {'\t', ','}, {' ', '.'}, {' ', ','}}};
  for (RowFormat const format : formats) {
    std::vector<std::string_view> const fields = fields_of(line, format, columns);
    bool const fits = fields.size() == columns && std::all_of(fields.begin(), fields.end(), [&](std::string_view f) {
                        return number(f, format.decimal).has_value();
                      });
    if (fits) return format;
  }
  return {separator_of(line), '.'};
}

/// Parses column names. A blank-separated header with units in brackets ("u [px/frame]") is split after each unit.
std::vector<std::string> column_names(std::string_view line) {
  line = trimmed(line);
  while (!line.empty() && (line.front() == '#' || line.front() == '%')) line = trimmed(line.substr(1));
  char const separator = separator_of(line);
  std::vector<std::string> names;
  if (separator == ' ' && line.find('[') != std::string_view::npos) {
    for (std::size_t at = 0; at < line.size();) {
      std::size_t const end = line.find(']', at);
      std::size_t const stop = end == std::string_view::npos ? line.size() : end + 1;
      names.emplace_back(trimmed(line.substr(at, stop - at)));
      at = std::min(line.find_first_not_of(blanks, stop), line.size());
    }
    return names;
  }
  for (std::string_view field : split(line, separator)) {
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    names.emplace_back(field);
  }
  while (!names.empty() && names.back().empty()) names.pop_back();  // a separator at the end of the line
  return names;
}

/// Parses the names of Tecplot's variables: the words after VARIABLES =, in quotation marks or separated by commas and
/// blanks, up to the next record of the header.
/// @param text  lines of the header, joined by blanks
/// @return empty if there is no VARIABLES record
std::vector<std::string> tecplot_variables(std::string const& text) {
  std::string const lower = lower_case(text);
  std::size_t at = lower.find("variables");
  if (at == std::string::npos) return {};
  at = lower.find_first_not_of(blanks, at + std::string_view("variables").size());
  if (at == std::string::npos || lower[at] != '=') return {};
  std::vector<std::string> names;
  for (++at; (at = text.find_first_not_of(" \t\r,", at)) != std::string::npos;) {
    bool const quoted = text[at] == '"';
    std::size_t const end = std::min(quoted ? text.find('"', at + 1) : text.find_first_of(" \t,", at), text.size());
    std::string const word = text.substr(quoted ? at + 1 : at, quoted ? end - at - 1 : end - at);
    std::string const record = lower_case(word);
    if (!quoted && (record.starts_with("zone") || record.starts_with("title") || record.find('=') != std::string::npos))
      break;
    names.push_back(word);
    at = quoted ? end + 1 : end;
  }
  return names;
}

/// Returns true if the values of a zone are stored variable by variable.
bool is_block_packed(std::string const& header) {
  std::string packed = lower_case(header);
  std::erase_if(packed, [](unsigned char c) { return std::isspace(c) != 0; });
  return packed.find("f=block") != std::string::npos || packed.find("datapacking=block") != std::string::npos;
}

bool is_unit(std::string_view word) {
  constexpr std::array<std::string_view, 16> units{"px",          "pix",  "pixel",   "pixels",  "px/frame", "pix/frame",
                                                   "pixel/frame", "m",    "mm",      "cm",      "um",       "m/s",
                                                   "mm/s",        "cm/s", "m/frame", "mm/frame"};
  return std::find(units.begin(), units.end(), word) != units.end();
}

}  // namespace

bool is_pixel_unit(std::string_view unit) {
  return unit.empty() || unit == "-" || unit.starts_with("px") || unit.starts_with("pix");
}

ColumnName parse_column_name(std::string_view name) {
  ColumnName parsed;
  std::string rest;
  std::string* into = &rest;
  std::string bracket;
  for (char const c : lower_case(name)) {
    if (c == '[' || c == '(') {
      bracket.clear();
      into = &bracket;
    } else if (c == ']' || c == ')') {
      if (into == &bracket) parsed.unit = trimmed(bracket);
      into = &rest;
    } else {
      into->push_back(c);
    }
  }
  std::string_view quantity = trimmed(rest);
  for (std::string_view const prefix : {"velocity ", "displacement "}) {
    if (quantity.starts_with(prefix)) quantity = trimmed(quantity.substr(prefix.size()));
  }
  auto const end = quantity.find_last_of(" _");
  if (end != std::string_view::npos && is_unit(quantity.substr(end + 1))) {
    if (parsed.unit.empty()) parsed.unit = quantity.substr(end + 1);
    quantity = trimmed(quantity.substr(0, end));
  }
  parsed.quantity = quantity;
  return parsed;
}

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

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
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
  RowFormat format;
  auto const name_columns = [&](std::size_t at, std::string_view row) {
    std::string whole;
    for (std::string const& line : table.preamble) whole += line + ' ';
    whole += header;
    table.names = tecplot_variables(whole);
    table.tecplot = !table.names.empty();
    if (table.tecplot && is_block_packed(whole))
      fail(table.header_line, "is Tecplot's BLOCK packing (values variable by variable); export it in POINT packing");
    if (table.header_line == 0) {
      table.has_header = false;
      if (!lower_case(path).ends_with(".jvc"))
        fail(at, "no header line (numbers from the start); put the names of the columns first, such as x,y,u,v");
      table.names = {"x", "y", "u", "v"};
      if (split(row, row_format(row, 5).separator).size() > 4) table.names.emplace_back("quality");
    } else if (!table.tecplot) {
      table.names = column_names(header);
    }
    table.values.resize(table.names.size());
    format = row_format(row, table.names.size());
  };
  while (auto const line = file.next()) {
    std::size_t const at = file.number();
    std::string_view text = *line;
    text = trimmed(text);
    if (text.empty()) continue;

    // Skip the lines before the first row of numbers; the last of them is the header.
    if (format.separator == 0 && !number(split(text, separator_of(text)).front(), ',')) {
      if (at > most_lines_before_numbers) {
        fail(at, fmt::format("no row of numbers in {} lines; is this a table of vectors?", most_lines_before_numbers));
      }
      if (table.header_line != 0) table.preamble.push_back(header);
      header = text;
      table.header_line = at;
      continue;
    }
    if (format.separator == 0) name_columns(at, text);
    if (text.front() == '#') continue;
    if (table.tecplot && lower_case(text.substr(0, 4)) == "zone") {
      table.warnings.push_back(fmt::format("{}:{}: another zone begins here; the first alone is read", path, at));
      break;
    }

    std::vector<std::string_view> const fields = fields_of(text, format, table.names.size());
    if (fields.size() != table.names.size()) {
      fail(at, fmt::format("{} fields where the header names {} columns ({})", fields.size(), table.names.size(),
                           excerpt(fmt::format("{}", fmt::join(table.names, ", ")), 200)));
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
  return table;
}

}  // namespace gladstone::detail
