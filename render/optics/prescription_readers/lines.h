#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gladstone {

/// A line of a prescription, cut into words.
struct PrescriptionLine {
  std::string where;  ///< file:line
  std::vector<std::string> words;

  std::size_t size() const { return words.size(); }
  std::string const& operator[](std::size_t i) const { return words[i]; }
  /// Word i as a finite number. @throws DataError where there is none
  double number(std::size_t i) const;
  /// Word i as a whole number. @throws DataError
  int integer(std::size_t i) const;
};

/// Words between blanks; text in quotes, of either kind, is one word and loses them.
std::vector<std::string> quoted_words(std::string_view line);

}  // namespace gladstone
