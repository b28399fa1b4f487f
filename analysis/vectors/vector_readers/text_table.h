#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/vectors/vector_readers/table_header.h"
#include "render/base/warning.h"

namespace gladstone::inline vectors {

/// Text file of numbers in columns, common to all readers of foreign vectors.
struct TextTable {
  std::string path;
  std::vector<std::string> preamble;        ///< lines before the header
  std::vector<std::string> names;           ///< column names as in the file, without quotes and surrounding blanks
  std::size_t header_line = 0;              ///< line number of the header, from 1; 0: no header
  std::vector<std::vector<double>> values;  ///< values of each column
  std::vector<std::size_t> line;            ///< line number of each row, from 1
  bool tecplot = false;                     ///< the names are from Tecplot's VARIABLES
  bool davis = false;                       ///< the names are from the header of DaVis' text export
  bool has_header = true;                   ///< false: the names are defined by the format
  Warnings warnings;                        ///< "file:line: ..." about ignored parts of the file
  bool complete = true;                     ///< false: the header declares another number of rows

  std::size_t rows() const { return line.size(); }
  /// Returns the index of the first column with one of these names, ignoring case.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> any_of) const;
  /// Returns the values of the first column with one of these names. @throws DataError with the available column names
  /// if there is none
  std::vector<double> const& column(std::initializer_list<std::string_view> any_of) const;

  /// Returns the index of the column of one of these quantities: a column in px is preferred to one in another unit,
  /// and this one to a column without unit.
  std::optional<std::size_t> find_quantity(std::initializer_list<std::string_view> any_of) const;
  /// Returns the column index like find_quantity(). @throws DataError with the available column names if there is no
  /// such column
  std::size_t quantity(std::initializer_list<std::string_view> any_of) const;
  /// Reports a missing column. @throws DataError with the available column names
  [[noreturn]] void refuse_missing(std::string_view wanted) const;
};

/// Reads a table. The last line before the numbers contains the column names (a leading "# " is ignored) unless
/// Tecplot's VARIABLES or DaVis' "#DaVis" does; JPIV's .jvc has no header. Separators are comma, semicolon, tab or
/// blanks; the decimal separator is a point or, with another field separator or in quotation marks, a comma. If the
/// number of rows differs from that declared in the header, a warning is added and `complete` is false.
/// @throws DataError with file:line for an empty file, a missing header, a row with a wrong number of fields, a field
///         that is not a number, values in cells of Tecplot, or 3D vectors of DaVis
TextTable read_text_table(std::string const& path);

}  // namespace gladstone::inline vectors
