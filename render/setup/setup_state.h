#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_node.h"
#include "render/setup/setup_record.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline setup {

/// Location and absolute path of a value that is a file name.
struct SetupFileName {
  std::vector<std::string> path;
  std::string absolute;
};

/// State shared by a SetupDocument and its SetupTables. Paths are the keys from the root, with "[2]" for an element of
/// an array.
struct SetupDocument::State {
  std::string name;    ///< file name for messages
  std::string folder;  ///< directory to which relative file names refer
  SetupNode root;
  SetupRecord record;
  std::vector<SetupProblem> problems;
  std::vector<SetupFileName> files;  ///< file names that were read

  /// Returns the value at a path; null if there is none.
  SetupNode const* find(std::vector<std::string> const& path) const;
  SetupNode* find(std::vector<std::string> const& path) {
    return const_cast<SetupNode*>(std::as_const(*this).find(path));
  }
  /// Returns the record of the table at a path, creating it if necessary.
  SetupRecord& find_or_create_record(std::vector<std::string> const& path);
  std::string where(SetupPlace const& place) const;
  /// Location of the value at a path, or of the nearest existing table above it, for messages.
  std::string where(std::vector<std::string> const& path) const;
  /// Resolves a file name relative to the directory of the file in which it is written.
  std::string absolute_name(SetupNode const& text) const;
};

/// Adds problems for the keys that were not read, at most max_reported_problems.
/// @return number of such keys
std::size_t add_unread(SetupDocument::State& state);

/// Formats a path: "medium.field[0].kind".
std::string dotted_path(std::vector<std::string> const& path);

}  // namespace gladstone::inline setup
