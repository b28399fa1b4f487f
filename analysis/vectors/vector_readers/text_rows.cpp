#include "analysis/vectors/vector_readers/text_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "render/base/text.h"

namespace gladstone::inline vectors {

char detect_separator(std::string_view line) {
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
    std::size_t const text = line.find_first_not_of(" \r", at);
    bool const quoted = text != std::string_view::npos && line[text] == '"';
    std::size_t const close = quoted ? line.find('"', text + 1) : std::string_view::npos;
    std::size_t const end = std::min(line.find(separator, close == std::string_view::npos ? at : close), line.size());
    std::string_view field = trim(line.substr(at, end - at));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    fields.push_back(field);
    if (end == line.size()) return fields;
    at = end + 1;
  }
}

std::optional<double> number(std::string_view text, char decimal) {
  if (decimal == ',' && text.find(',') != std::string_view::npos) {
    std::string point(text);
    std::replace(point.begin(), point.end(), ',', '.');
    return number(point);
  }
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  // outside the range of double: 1e400 becomes infinite, 1e-400 becomes 0
  if (error == std::errc::result_out_of_range) {
    bool const tiny = text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos;
    value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return text.front() == '-' ? -value : value;
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

std::vector<std::string_view> fields_of(std::string_view line, RowFormat format, std::size_t columns) {
  std::vector<std::string_view> fields = split(line, format.separator);
  if (fields.size() == columns + 1 && fields.back().empty()) fields.pop_back();
  return fields;
}

RowFormat row_format(std::string_view line, std::size_t columns) {
  // the last of these formats requires fields in quotation marks
  constexpr std::array<RowFormat, 8> formats{
      {{';', '.'}, {';', ','}, {',', '.'}, {'\t', '.'}, {'\t', ','}, {' ', '.'}, {' ', ','}, {',', ','}}};
  for (RowFormat const format : formats) {
    std::vector<std::string_view> const fields = fields_of(line, format, columns);
    bool const fits = fields.size() == columns && std::all_of(fields.begin(), fields.end(), [&](std::string_view f) {
                        return number(f, format.decimal).has_value();
                      });
    if (fits) return format;
  }
  return {detect_separator(line), '.'};
}

bool has_ambiguous_commas(std::string_view line, std::size_t columns) {
  if (line.find_first_of(".;\t") != std::string_view::npos) return false;
  std::vector<std::string_view> const fields = split(line, ',');
  return fields.size() > columns && fields.size() <= 2 * columns &&
         std::all_of(fields.begin(), fields.end(), [](std::string_view f) { return number(f).has_value(); });
}

}  // namespace gladstone::inline vectors
