#include "render/files/tecplot_zone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {

std::optional<double> assigned_number(std::string_view text, std::string_view key) {
  constexpr std::string_view blanks = " \t\r";
  std::string const lower = lower_case(text);
  bool quoted = false;
  for (std::size_t at = 0; at < lower.size(); ++at) {
    if (lower[at] == '"') quoted = !quoted;
    auto const is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    bool const begins = at == 0 || !is_word(static_cast<unsigned char>(lower[at - 1]));
    if (quoted || !begins || std::string_view(lower).substr(at, key.size()) != key) continue;
    std::size_t const equals = lower.find_first_not_of(blanks, at + key.size());
    if (equals == std::string::npos || lower[equals] != '=') continue;
    std::size_t const from = lower.find_first_not_of(blanks, equals + 1);
    if (from == std::string::npos) continue;
    double value = 0;
    std::size_t const to = std::min(lower.find_first_not_of("0123456789", from), lower.size());
    if (std::from_chars(&lower[from], lower.data() + to, value).ec == std::errc() && value > 0) return value;
  }
  return std::nullopt;
}

TecplotZone parse_tecplot_zone(std::string const& header) {
  std::string packed = lower_case(header);
  std::erase_if(packed, [](unsigned char c) { return std::isspace(c) != 0; });
  auto const has = [&](char const* text) { return packed.find(text) != std::string::npos; };
  TecplotZone zone{has("f=block") || has("datapacking=block"), has("cellcentered"), std::nullopt};
  std::size_t const begin = lower_case(header).find("zone");
  if (begin == std::string::npos) return zone;
  for (std::string_view const key : {"i", "j", "k"}) {
    auto const size = assigned_number(std::string_view(header).substr(begin), key);
    if (size) zone.points = zone.points.value_or(1.0) * *size;
  }
  return zone;
}

void BlockValues::add(double value, std::size_t line) {
  require_room(line_, path_, "values");
  values_.push_back(value);
  line_.push_back(line);
}

std::vector<std::vector<double>> BlockValues::split(std::size_t variables, std::optional<double> declared) const {
  std::size_t const complete = values_.size() / variables;
  double const points = declared.value_or(static_cast<double>(complete));
  double const needed = points * static_cast<double>(variables);
  if (needed != static_cast<double>(values_.size())) {
    throw DataError(ErrorCode::damaged, path_,
                    fmt::format("contains {} values in BLOCK packing, but {} variables at {} points need {}; export it "
                                "again",
                                values_.size(), variables, points, needed));
  }
  std::vector<std::vector<double>> columns;
  auto const count = static_cast<std::ptrdiff_t>(complete);
  for (auto at = values_.begin(); at != values_.end(); at += count) columns.emplace_back(at, at + count);
  return columns;
}

std::vector<std::size_t> BlockValues::lines(std::size_t points) const {
  return {line_.begin(), line_.begin() + static_cast<std::ptrdiff_t>(points)};
}

}  // namespace gladstone::inline files
