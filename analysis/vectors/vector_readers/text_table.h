#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::detail {

/// What a column's name says: "U pix[pix]" is the quantity "u" in "pix".
struct ColumnName {
  std::string quantity;  ///< in small letters, without its unit
  std::string unit;      ///< in small letters; empty: not stated
};
ColumnName parse_column_name(std::string_view name);

/// A text file of numbers in columns: what the readers of foreign vectors share.
struct TextTable {
  std::string path;
  std::vector<std::string> preamble;        ///< lines before the header
  std::vector<std::string> names;           ///< of the columns, as written, without quotes and outer blanks
  std::size_t header_line = 0;              ///< its number, from 1
  std::vector<std::vector<double>> values;  ///< by column
  std::vector<std::size_t> line;            ///< of each row
  bool tecplot = false;                     ///< the names are those of Tecplot's VARIABLES
  bool has_header = true;                   ///< false: the names are those of the format
  std::vector<std::string> warnings;        ///< "file:line: ..." of what was not read

  std::size_t rows() const { return line.size(); }
  /// The first column with one of these names, ignoring case.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> any_of) const;
  /// The same, or DataError naming the columns there are.
  std::vector<double> const& column(std::initializer_list<std::string_view> any_of) const;

  /// The column of one of these quantities, whatever its unit: in px if there is one, else in another unit, else the
  /// first without any.
  std::optional<std::size_t> find_quantity(std::initializer_list<std::string_view> any_of) const;
  /// The same, or DataError naming the columns there are.
  std::size_t quantity(std::initializer_list<std::string_view> any_of) const;
  /// @throws DataError naming the columns there are
  [[noreturn]] void refuse_missing(std::string_view wanted) const;
};

/// Whether a unit, as ColumnName has it, is that of pixels (or is not stated).
bool is_pixel_unit(std::string_view unit);

/// Reads a table whose last line before the numbers names the columns ("# " in front is dropped), or Tecplot's
/// VARIABLES; JPIV's .jvc has no header. Separators are comma, semicolon, tab or blanks, decimals have a point or, with
/// another separator, a comma.
/// @throws DataError with file:line for an empty file, no header, a row with another number of fields, a field that is
/// not a number, Tecplot's BLOCK packing
TextTable read_text_table(std::string const& path);

/// Text in small letters.
std::string lower_case(std::string_view text);

}  // namespace gladstone::detail
