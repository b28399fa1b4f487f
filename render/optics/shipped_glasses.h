#pragma once

#include <string_view>
#include <vector>

namespace gladstone::inline optics {

/// Catalogue of glasses that is compiled into the program.
struct ShippedText {
  std::string_view name;                ///< file name without folder and extension
  std::vector<std::string_view> parts;  ///< text of the file in pieces; all except the first start with a line NM
};

/// Returns every catalogue in data/glasses. The texts are compiled in, so that the program does not depend on its
/// location.
std::vector<ShippedText> const& shipped_glasses();

}  // namespace gladstone::inline optics
