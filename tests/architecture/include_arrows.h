#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::architecture {

/// One #include line of a source file.
struct Include {
  int line = 0;
  std::string target;   ///< text between the quotes or brackets; the raw text without either
  bool quoted = false;  ///< "target" rather than <target>
};

/// Returns the #include lines of a C++ source, excluding comments.
std::vector<Include> includes_of(std::string_view source);

/// Returns the room of a path from the root of the tree ("render/base", "studies", ...); empty if there is none.
std::string room_of(std::string_view path);

/// Returns the library of a header in angle brackets ("std", "Eigen", "CUDA", ...); empty if it is unknown.
std::string library_of(std::string_view header);

/// Returns the rooms of the table, each with the other rooms that it may include.
std::map<std::string, std::set<std::string>> permitted_rooms();

/// Checks one source file against the table of rooms and arrows.
/// @param path   path from the root of the tree, e.g. "render/base/vec.h"; its folder determines the room
/// @param source text of the file
/// @return one line "path:line: problem" for every other include that the table does not permit
std::vector<std::string> forbidden_arrows(std::string const& path, std::string_view source);

}  // namespace gladstone::architecture
