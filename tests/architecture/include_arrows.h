#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gladstone::architecture {

/// One #include line of a source file.
struct Include {
  int line = 0;
  std::string target;   ///< what stands between the quotes or brackets; the raw text where there are neither
  bool quoted = false;  ///< "target" rather than <target>
};

/// The #include lines of a C++ source, those in comments left out.
std::vector<Include> includes_of(std::string_view source);

/// The room that a path from the root of the tree lies in ("render/base", "studies", ...); empty: none.
std::string room_of(std::string_view path);

/// The library that a header in angle brackets belongs to ("std", "Eigen", "CUDA", ...); empty: none that we know.
std::string library_of(std::string_view header);

/// An arrow that the table does not have and that one file still needs.
struct Exception {
  std::string file;    ///< path of the including file, from the root of the tree
  std::string target;  ///< the included header
};

/// The exceptions to the table. The list only shrinks: new code follows the table.
std::vector<Exception> const& known_exceptions();

/// Checks one source file against the table of rooms and arrows.
/// @param path   from the root of the tree, e.g. "render/base/vec.h"; its folder says the room
/// @param source the file's text
/// @param exceptions  arrows that are permitted in addition to the table
/// @return one line "path:line: what is wrong" for every other arrow that the table does not have
std::vector<std::string> forbidden_arrows(std::string const& path, std::string_view source,
                                          std::vector<Exception> const& exceptions = known_exceptions());

}  // namespace gladstone::architecture
