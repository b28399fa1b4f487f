#include "render/optics/prescription_readers/lines.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "render/base/error.h"

namespace gladstone {

double PrescriptionLine::number(std::size_t i) const {
  if (i >= words.size()) throw DataError(where, fmt::format("{} needs {} values; the line is cut short", words[0], i));
  std::string_view word = words[i];
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw DataError(where, fmt::format("{}: \"{}\" is not a finite number", words[0], words[i].substr(0, 40)));
  }
  return value;
}

int PrescriptionLine::integer(std::size_t i) const {
  double const value = number(i);
  if (value != std::floor(value) || std::abs(value) > 1e6) {
    throw DataError(where, fmt::format("{}: \"{}\" is not a whole number", words[0], words[i]));
  }
  return static_cast<int>(value);
}

std::vector<std::string> quoted_words(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;
       at = line.find_first_not_of(" \t", at)) {
    bool const quoted = line[at] == '"' || line[at] == '\'';
    std::size_t const begin = quoted ? at + 1 : at;
    std::size_t end = quoted ? line.find(line[at], begin) : line.find_first_of(" \t", begin);
    if (end == std::string_view::npos) end = line.size();
    words.emplace_back(line.substr(begin, end - begin));
    at = std::min(quoted ? end + 1 : end, line.size());
  }
  return words;
}

}  // namespace gladstone
