#include "analysis/vectors/vector_readers/text_table.h"

#include <fmt/format.h>

#include <algorithm>
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

/// The separator of a line: the first of comma, semicolon, tab that it holds, else blank.
char separator_of(std::string_view line) {
  for (char const candidate : {',', ';', '\t'}) {
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

std::optional<double> number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // of a double: 1e400 is infinite, 1e-400 nothing
    bool const tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
    value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return text.front() == '-' ? -value : value;
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// Column names; a header in blanks whose names carry their unit in brackets ("u [px/frame]") is cut after each unit.
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
  while (!names.empty() && names.back().empty()) names.pop_back();  // a separator that ends the line
  return names;
}

}  // namespace

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

std::vector<double> const& TextTable::column(std::initializer_list<std::string_view> any_of) const {
  if (auto const found = find(any_of)) return values[*found];
  throw DataError(fmt::format("{}:{}", path, header_line),
                  fmt::format("no column {} (the columns are {}); name it in the header line", *any_of.begin(),
                              excerpt(fmt::format("{}", fmt::join(names, ", ")), 200)));
}

TextTable read_text_table(std::string const& path) {
  LineReader file(path, "a file of vectors");
  TextTable table;
  table.path = path;
  auto const fail = [&](std::size_t at, std::string const& message) {
    throw DataError(fmt::format("{}:{}", path, at), message);
  };

  std::string header;
  char separator = 0;
  while (auto const line = file.next()) {
    std::size_t const at = file.number();
    std::string_view text = *line;
    if (at == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    text = trimmed(text);
    if (text.empty()) continue;

    // Lines before the first row of numbers: the last of them is the header.
    if (separator == 0 && !number(split(text, separator_of(text)).front())) {
      if (at > most_lines_before_numbers) {
        fail(at, fmt::format("no row of numbers in {} lines; is this a table of vectors?", most_lines_before_numbers));
      }
      if (table.header_line != 0) table.preamble.push_back(header);
      header = text;
      table.header_line = at;
      continue;
    }
    if (separator == 0) {
      if (table.header_line == 0) {
        fail(at, "no header line (numbers from the start); put the names of the columns first, such as x,y,u,v");
      }
      table.names = column_names(header);
      table.values.resize(table.names.size());
      separator = separator_of(text);
    }
    if (text.front() == '#') continue;

    std::vector<std::string_view> const fields = split(text, separator);
    if (fields.size() != table.names.size()) {
      fail(at, fmt::format("{} fields where the header names {} columns ({})", fields.size(), table.names.size(),
                           excerpt(fmt::format("{}", fmt::join(table.names, ", ")), 200)));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      std::optional<double> const value = number(fields[i]);
      if (!value) fail(at, fmt::format("{} = \"{}\" is not a number", excerpt(table.names[i]), excerpt(fields[i])));
      table.values[i].push_back(*value);
    }
    require_room(table.line, path, "vectors");
    table.line.push_back(at);
  }
  if (table.header_line == 0) throw DataError(path + ":1", "the file is empty");
  if (table.line.empty()) fail(table.header_line, "no row of numbers follows the header");
  return table;
}

}  // namespace gladstone::detail
