#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone::inline sweep {

/// Formats case numbers as a short text: "0-3,7,9-10". @pre in ascending order
std::string case_list(std::vector<std::size_t> const& cases);

/// Parses a text of the form of case_list() to case numbers in ascending order, without duplicates.
/// @param count  number of cases of the study
/// @throws DataError if the text is not a list of cases, or contains a number >= count
std::vector<std::size_t> parse_case_list(std::string const& text, std::size_t count);

}  // namespace gladstone::inline sweep
