#pragma once

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

/// An include that the table does not permit but one file still requires.
struct Exception {
  std::string file;    ///< path of the including file, from the root of the tree
  std::string target;  ///< the included header
};

/// Returns the exceptions to the table. The list may only become shorter: new code must follow the table.
std::vector<Exception> const& known_exceptions();

/// Checks one source file against the table of rooms and arrows.
/// @param path   path from the root of the tree, e.g. "render/base/vec.h"; its folder determines the room
/// @param source text of the file
/// @param exceptions  arrows that are permitted in addition to the table
/// @return one line "path:line: problem" for every other include that the table does not permit
std::vector<std::string> forbidden_arrows(std::string const& path, std::string_view source,
                                          std::vector<Exception> const& exceptions = known_exceptions());

}  // namespace gladstone::architecture
