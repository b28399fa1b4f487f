#pragma once

#include <string>
#include <vector>

namespace gladstone::inline files {

/// Returns true if the text contains a wildcard (* ? [) and is not the name of a file.
bool is_pattern(std::string const& text);

/// Lists the files that match a pattern, in any order. @throws DataError if no file matches
std::vector<std::string> expand_pattern(std::string const& pattern);

/// Compares texts so that numbers in them are ordered by value (2 before 10).
bool is_naturally_before(std::string const& a, std::string const& b);

}  // namespace gladstone::inline files
