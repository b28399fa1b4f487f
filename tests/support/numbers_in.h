#pragma once

#include <cctype>
#include <cstdlib>
#include <string>
#include <vector>

namespace gladstone {

/// Returns the numbers in a text, in their order: "shifted by (16, -4) px" -> 16, -4. For tests about the values in a
/// message, whose wording is free. Digits in a word ("F26") do not count.
inline std::vector<double> numbers_in(std::string const& text) {
  auto const is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
  auto const is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::vector<double> found;
  for (std::size_t at = 0; at < text.size(); ++at) {
    bool const begins = is_digit(text[at]) || (text[at] == '-' && at + 1 < text.size() && is_digit(text[at + 1]));
    if (!begins || (at > 0 && is_word(text[at - 1]))) continue;
    char* end = nullptr;
    found.push_back(std::strtod(text.c_str() + at, &end));
    at = static_cast<std::size_t>(end - text.c_str()) - 1;
  }
  return found;
}

}  // namespace gladstone
