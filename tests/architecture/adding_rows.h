#pragma once

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace gladstone::architecture {

/// One row of the table.
struct Row {
  char const* thing;
  std::string folder;              ///< folder whose files are the entries
  std::regex name;                 ///< finds the names of an entry in its file, as the first group
  std::set<std::string> registry;  ///< files that a new entry touches
  /// Files that may name one particular entry, since they need this very entry and no other.
  std::map<std::string, std::set<std::string>> needed = {};
  bool quoted = false;    ///< the names are texts, such as the value of a key in a setup
  std::size_t least = 3;  ///< smallest number of entries that the expression must find
};

/// Returns the rows of the table "Adding something, in one place" of CONTRIBUTING.md.
std::vector<Row> const& rows();

}  // namespace gladstone::architecture
