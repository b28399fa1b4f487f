#pragma once

#include <gmock/gmock.h>

#include <cctype>
#include <string>

namespace gladstone {

/// Returns true if a text contains a value whose numbers do not continue beyond it: "12 px" contains "12" and "12 px",
/// but "120 px", "1.12 px", "-12 px" and "12.5 px" do not. "12.0" is the same number as "12".
inline bool contains_whole(std::string const& text, std::string const& value) {
  auto const is_digit = [&text](std::size_t at) {
    return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
  };
  auto const is = [&text](std::size_t at, char c) { return at < text.size() && text[at] == c; };
  auto const is_word = [&text](std::size_t at) {
    return at < text.size() && std::isalnum(static_cast<unsigned char>(text[at])) != 0;
  };
  bool const begins = !value.empty() && std::isdigit(static_cast<unsigned char>(value.front())) != 0;
  bool const ends = !value.empty() && std::isdigit(static_cast<unsigned char>(value.back())) != 0;
  for (std::size_t at = text.find(value); at != std::string::npos; at = text.find(value, at + 1)) {
    // positions before the beginning of the text are larger than its size
    bool const is_later_part = is_digit(at - 1) || (is(at - 1, '.') && is_digit(at - 2)) ||
                               (is(at - 1, '-') && !is_word(at - 2) && !is(at - 2, '-'));
    std::size_t end = at + value.size();
    bool const is_whole_number = value.find('.') == std::string::npos;
    if (ends && is_whole_number && is(end, '.') && is(end + 1, '0'))
      for (++end; is(end, '0');) ++end;
    bool const goes_on = is_digit(end) || (is(end, '.') && is_digit(end + 1)) ||
                         (is(end, 'e') && (is_digit(end + 1) || is(end + 1, '-') || is(end + 1, '+')));
    if (!(begins && is_later_part) && !(ends && goes_on)) return true;
  }
  return false;
}

/// Matches a text by contains_whole(), for the values in a message.
MATCHER_P(ContainsWhole, value, "contains \"" + std::string(value) + "\" with whole numbers") {
  return contains_whole(arg, value);
}

}  // namespace gladstone
