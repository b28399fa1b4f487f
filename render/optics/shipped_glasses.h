#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gladstone {

/// Returns name and text of every catalogue in data/glasses. The texts are compiled in, so that the program does not
/// depend on its location.
std::vector<std::pair<std::string, std::string>> const& shipped_glasses();

}  // namespace gladstone
