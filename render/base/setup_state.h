#pragma once

#include <string>
#include <vector>

#include "render/base/setup_node.h"
#include "render/base/setup_record.h"
#include "render/base/setup_table.h"

namespace gladstone {

/// A key, or an element of its array, whose value is the name of a file.
struct SetupFileName {
  std::vector<std::string> path;
  std::string absolute;
};

/// What a SetupDocument and its SetupTables share. Paths: keys from the root; "[2]" for an element of an array.
struct SetupDocument::State {
  std::string name;    ///< of the file, for messages
  std::string folder;  ///< relative file names refer to it
  SetupNode root;
  SetupRecord record;
  std::vector<SetupProblem> problems;
  std::vector<SetupFileName> files;  ///< that readers asked for

  /// The value at a path; null where there is none.
  SetupNode const* find(std::vector<std::string> const& path) const;
  SetupNode* find(std::vector<std::string> const& path) {
    return const_cast<SetupNode*>(std::as_const(*this).find(path));
  }
  /// The record of the table at a path, made where it is new.
  SetupRecord& record_of(std::vector<std::string> const& path);
  std::string where(SetupPlace const& place) const;
  /// Where the value at the path stands; where it is absent, the nearest table above it.
  std::string where(std::vector<std::string> const& path) const;
  /// The file that a text of the setup names: relative to the folder of the file that it stands in.
  std::string absolute_name(SetupNode const& text) const;
};

/// "medium.field[0].kind"
std::string dotted_path(std::vector<std::string> const& path);

}  // namespace gladstone
