#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gladstone::inline base {

/// Returns the part of a text between its first and last characters that are neither white space nor NUL (Fortran
/// programs pad with either). It is valid as long as the text.
std::string_view trim(std::string_view text);
/// Returns a copy of the part of a text that trim() returns.
inline std::string trimmed(std::string_view text) { return std::string(trim(text)); }

/// Converts a text to lower case (ASCII).
std::string lower_case(std::string_view text);

/// Shortens a text to `longest` bytes for a message, ending in "..." if it was cut.
std::string excerpt(std::string_view text, std::size_t longest = 60);

/// Returns a number with a noun in singular or plural: "1 thread", "4 threads".
std::string count_text(std::size_t count, std::string const& noun);

}  // namespace gladstone::inline base
