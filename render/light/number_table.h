#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/base/text_file.h"

namespace gladstone {

/// A CSV file of numbers under one header line, row by row.
class NumberTable {
 public:
  /// @param wanted what the file should be, for messages @param columns of the header
  /// @throws DataError for another header
  NumberTable(std::string const& path, std::string const& wanted, std::vector<std::string> const& columns);

  /// The next row; nothing at the end. Empty lines are passed over.
  /// @throws DataError at file:line for a line that is not so many finite numbers
  std::optional<std::vector<double>> next();
  /// "file:line" of the row that next() gave last.
  std::string place() const { return lines_.place(); }

 private:
  LineReader lines_;
  std::string header_;
  std::size_t columns_;
};

}  // namespace gladstone
