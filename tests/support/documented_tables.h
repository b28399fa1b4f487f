#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace gladstone::test {

/// Cells of each row of a table, without its header.
using DocumentedRows = std::vector<std::vector<std::string>>;

/// Returns the tables below a heading of docs/file-formats.md whose first column has the given title.
inline std::vector<DocumentedRows> documented_tables(std::string const& heading, std::string const& first_column) {
  std::ifstream page(GLADSTONE_DATA_DIR "/../docs/file-formats.md");
  std::vector<DocumentedRows> tables;
  bool in_section = false, in_any = false, in_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) in_section = line == "## " + heading;
    if (!in_section || !line.starts_with('|')) {
      in_any = in_table = false;
      continue;
    }
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) {
      auto const first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    if (!in_any) {
      in_any = true;
      in_table = cells[0] == first_column;
      if (in_table) tables.emplace_back();
    } else if (in_table && !cells[0].starts_with("---")) {
      tables.back().push_back(cells);
    }
  }
  EXPECT_FALSE(tables.empty()) << heading << ", " << first_column;
  return tables;
}

/// Returns the names in backticks. A name without a directory is in that of the preceding name: "`/pinhole/rvec`,
/// `tvec`".
inline std::vector<std::string> names_of(std::string const& cell) {
  std::vector<std::string> names;
  for (std::size_t at = cell.find('`'); at != std::string::npos; at = cell.find('`', at + 1)) {
    std::size_t const end = cell.find('`', at + 1);
    std::string name = cell.substr(at + 1, end - at - 1);
    if (name[0] != '/' && !names.empty() && names.back()[0] == '/')
      name.insert(0, names.back(), 0, names.back().rfind('/') + 1);
    names.push_back(name);
    at = end;
  }
  return names;
}

/// Returns the first table below a heading whose first column has the given title.
inline DocumentedRows documented_table(std::string const& heading, std::string const& first_column) {
  return documented_tables(heading, first_column).at(0);
}

/// Returns the names in backticks in the first column.
inline std::set<std::string> names_of_first_column(DocumentedRows const& rows) {
  std::set<std::string> names;
  for (auto const& cells : rows) {
    for (std::string const& name : names_of(cells[0])) names.insert(name);
  }
  return names;
}

}  // namespace gladstone::test
