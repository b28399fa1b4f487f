#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gladstone::inline files {

/// Returns the number in KEY=NUMBER or KEY = NUMBER outside of quotation marks, ignoring case.
/// @param key  in lower case; must not be preceded by a letter, digit or underscore
/// @return nullopt if there is none, or if it is not a whole number above 0
std::optional<double> assigned_number(std::string_view text, std::string_view key);

/// Storage of the values of a zone of a Tecplot ASCII file.
struct TecplotZone {
  bool block = false;            ///< variable by variable (BLOCK packing) instead of point by point
  bool cell_centered = false;    ///< some variables have values in cells instead of at points
  std::optional<double> points;  ///< number of points, I times J times K; empty: not declared
};

/// Parses the lines before the numbers of a file, joined by blanks.
TecplotZone parse_tecplot_zone(std::string const& header);

/// Values of a zone in BLOCK packing, collected line by line; lines may end anywhere within a variable.
class BlockValues {
 public:
  explicit BlockValues(std::string path) : path_(std::move(path)) {}

  /// @throws DataError if the memory does not suffice
  void add(double value, std::size_t line);
  /// Returns the values of each variable.
  /// @param declared  number of points that the header declares
  /// @throws DataError if there are more or fewer values than `variables` times the points
  std::vector<std::vector<double>> split(std::size_t variables, std::optional<double> declared) const;
  /// Returns the line number of the first variable at each of the points.
  std::vector<std::size_t> lines(std::size_t points) const;

 private:
  std::string path_;
  std::vector<double> values_;
  std::vector<std::size_t> line_;  ///< line number of each value
};

}  // namespace gladstone::inline files
