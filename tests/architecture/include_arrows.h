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

/// Checks one source file against the table of rooms and arrows.
/// @param path   from the root of the tree, e.g. "render/base/vec.h"; its folder says the room
/// @param source the file's text
/// @return one line "path:line: what is wrong" for every arrow that the table does not have
std::vector<std::string> forbidden_arrows(std::string const& path, std::string_view source);

}  // namespace gladstone::architecture
