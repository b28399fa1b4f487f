#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/files/text_file.h"

namespace gladstone::inline light {

/// Reader of a CSV file of numbers with one header line.
class NumberTable {
 public:
  /// Opens the file and checks its header.
  /// @param wanted   expected content, for messages ("a table of particles")
  /// @param columns  expected column names
  /// @throws DataError if the header differs
  NumberTable(std::string const& path, std::string const& wanted, std::vector<std::string> const& columns);

  /// Returns the next row, skipping empty lines, or nullopt at the end of the file.
  /// @throws DataError with file:line if a line does not consist of one finite number per column
  std::optional<std::vector<double>> next();
  /// Number of the line of the row last returned by next().
  std::size_t number() const { return lines_.number(); }
  /// Location "file:line" of the row last returned by next().
  std::string place() const { return lines_.place(); }

 private:
  LineReader lines_;
  std::string header_;
  std::size_t columns_;
};

}  // namespace gladstone::inline light
