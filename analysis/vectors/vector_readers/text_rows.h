#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline vectors {

/// Characters that separate words.
inline constexpr std::string_view blanks = " \t\r";

/// Returns the separator of a line: the first of semicolon, tab and comma (possibly a decimal comma) that occurs in it,
/// else a blank.
char detect_separator(std::string_view line);

/// Splits a line into fields without surrounding blanks. A field in quotation marks may contain the separator (RFC
/// 4180), and its quotation marks are removed; with blanks as separator, quotation marks have no meaning.
std::vector<std::string_view> split(std::string_view line, char separator);

/// Number format of a row.
struct RowFormat {
  char separator = 0;  ///< character between fields; 0: not yet determined
  char decimal = '.';
};

/// Parses a number; numbers outside of the range of double are infinite or 0.
/// @return nullopt if the text is not a number
std::optional<double> number(std::string_view text, char decimal = '.');

/// Splits a row into fields; ignores a separator at the end of the line.
std::vector<std::string_view> fields_of(std::string_view line, RowFormat format, std::size_t columns);

/// Returns the format in which a row has as many numbers as there are columns; if there is none, the separator of the
/// line.
RowFormat row_format(std::string_view line, std::size_t columns);

/// Returns true if a row has more fields than columns because commas separate fields and mark decimals as well, such as
/// "11,5,2,25" for two columns.
bool has_ambiguous_commas(std::string_view line, std::size_t columns);

}  // namespace gladstone::inline vectors
