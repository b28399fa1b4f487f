#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::detail {

/// A text file of numbers in columns: what the readers of foreign vectors share.
struct TextTable {
  std::string path;
  std::vector<std::string> preamble;        ///< lines before the header
  std::vector<std::string> names;           ///< of the columns, as written, without quotes and outer blanks
  std::size_t header_line = 0;              ///< its number, from 1
  std::vector<std::vector<double>> values;  ///< by column
  std::vector<std::size_t> line;            ///< of each row

  std::size_t rows() const { return line.size(); }
  /// The first column with one of these names, ignoring case.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> any_of) const;
  /// The same, or DataError naming the columns there are.
  std::vector<double> const& column(std::initializer_list<std::string_view> any_of) const;
};

/// Reads a table whose last line before the numbers names the columns ("# " in front is dropped); separators are
/// comma, semicolon, tab or blanks. @throws DataError with file:line for an empty file, no header, a row with
/// another number of fields, a field that is not a number
TextTable read_text_table(std::string const& path);

/// Text in small letters.
std::string lower_case(std::string_view text);

}  // namespace gladstone::detail
