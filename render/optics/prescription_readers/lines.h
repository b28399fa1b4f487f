#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/optics/prescription.h"

namespace gladstone {

/// A line of a prescription, cut into words.
struct PrescriptionLine {
  std::string where;  ///< file:line
  std::vector<std::string> words;

  std::size_t size() const { return words.size(); }
  std::string const& operator[](std::size_t i) const { return words[i]; }
  /// Word i as a finite number. @throws DataError where there is none
  double number(std::size_t i) const;
  /// The same, with INF or INFINITY, in any case and of either sign, for an infinite one.
  double number_or_infinity(std::size_t i) const;
  /// Word i as a whole number. @throws DataError
  int integer(std::size_t i) const;
  /// Whether any word behind the first is a number other than 0; words that are no numbers do not count.
  bool has_nonzero_number() const;
};

/// A text in capitals (ASCII).
std::string in_capitals(std::string text);

/// The glass that a code describes: MIL-G-174's six digits (517642: nd 1.517, Vd 64.2), as many for either value
/// (516800641667), digits about a point (517.642, 516800.641667), or both values about a colon (1.5168:64.17).
/// Vd of 0 is an index without dispersion.
/// @return nothing for other words
std::optional<PrescribedMedium> read_glass_code(std::string_view word);

/// Words between blanks; text in quotes, of either kind, is one word and loses them.
std::vector<std::string> quoted_words(std::string_view line);

}  // namespace gladstone
