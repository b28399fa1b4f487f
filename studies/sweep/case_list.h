#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone {

/// Case numbers as a short text: "0-3,7,9-10". @pre growing
std::string case_list(std::vector<std::size_t> const& cases);

/// The numbers of such a text, growing, each once.
/// @param count cases of the study
/// @throws DataError where the text is no list of cases, or names one from `count` on
std::vector<std::size_t> parse_case_list(std::string const& text, std::size_t count);

}  // namespace gladstone
