#include "analysis/vectors/vector_readers/table_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "analysis/vectors/vector_readers/text_rows.h"
#include "render/base/text.h"
#include "render/files/tecplot_zone.h"

namespace gladstone::inline vectors {
namespace {

bool is_unit(std::string_view word) {
  constexpr std::array<std::string_view, 16> units{"px",          "pix",  "pixel",   "pixels",  "px/frame", "pix/frame",
                                                   "pixel/frame", "m",    "mm",      "cm",      "um",       "m/s",
                                                   "mm/s",        "cm/s", "m/frame", "mm/frame"};
  return std::find(units.begin(), units.end(), word) != units.end();
}

/// Splits a line into words; a word in quotation marks may contain blanks, and the marks are removed.
std::vector<std::string_view> quoted_words(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
    bool const quoted = line[at] == '"';
    std::size_t const begin = quoted ? at + 1 : at;
    std::size_t const end = std::min(quoted ? line.find('"', begin) : line.find_first_of(blanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    at = line.find_first_not_of(blanks, std::min(quoted ? end + 1 : end, line.size()));
  }
  return words;
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
      if (into == &bracket) parsed.unit = trim(bracket);
      into = &rest;
    } else {
      into->push_back(c);
    }
  }
  std::string_view quantity = trim(rest);
  for (std::string_view const prefix : {"velocity ", "displacement "}) {
    if (quantity.starts_with(prefix)) quantity = trim(quantity.substr(prefix.size()));
  }
  auto const end = quantity.find_last_of(" _");
  if (end != std::string_view::npos && is_unit(quantity.substr(end + 1))) {
    if (parsed.unit.empty()) parsed.unit = quantity.substr(end + 1);
    quantity = trim(quantity.substr(0, end));
  }
  parsed.quantity = quantity;
  return parsed;
}

std::vector<std::string> column_names(std::string_view line) {
  line = trim(line);
  while (!line.empty() && (line.front() == '#' || line.front() == '%')) line = trim(line.substr(1));
  char const separator = detect_separator(line);
  std::vector<std::string> names;
  if (separator == ' ' && line.find('[') != std::string_view::npos) {
    for (std::size_t at = 0; at < line.size();) {
      std::size_t const end = line.find(']', at);
      std::size_t const stop = end == std::string_view::npos ? line.size() : end + 1;
      names.emplace_back(trim(line.substr(at, stop - at)));
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

std::optional<DavisHeader> parse_davis_header(std::string_view line) {
  if (!lower_case(trim(line)).starts_with("#davis")) return std::nullopt;
  std::vector<std::string_view> const words = quoted_words(line);
  auto const word = [&](std::size_t i) { return i < words.size() ? words[i] : std::string_view(); };
  DavisHeader header;
  header.planar = lower_case(word(2)) == "2d-vector";
  std::optional<double> const first = number(word(4)), second = number(word(5));
  if (first && second && *first > 0.0 && *second > 0.0) header.vectors = *first * *second;
  constexpr std::size_t x_unit = 7, y_unit = 9, displacement_unit = 11;
  auto const add_column = [&](std::string_view name, std::size_t unit) {
    header.names.push_back(word(unit).empty() ? std::string(name) : fmt::format("{} [{}]", name, word(unit)));
  };
  add_column("x", x_unit);
  add_column("y", y_unit);
  add_column("Vx", displacement_unit);
  add_column("Vy", displacement_unit);
  return header;
}

void DeclaredVectors::add(std::string_view line, std::size_t line_number) {
  auto const multiply = [&](std::optional<double> size) {
    if (!size) return;
    count_ = count_.value_or(1.0) * *size;
    line_ = line_number;
  };
  if (std::optional<DavisHeader> const davis = parse_davis_header(line)) {
    multiply(davis->vectors);
  } else if (lower_case(line).starts_with("gridsize")) {
    multiply(assigned_number(line, "width"));
    multiply(assigned_number(line, "height"));
  } else if (in_zone_ = in_zone_ || lower_case(line).find("zone") != std::string::npos; in_zone_) {
    for (std::string_view const key : {"i", "j", "k"}) multiply(assigned_number(line, key));
  }
}

}  // namespace gladstone::inline vectors
