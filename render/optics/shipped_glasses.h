#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gladstone {

/// Name and text of every catalogue in data/glasses. The texts are built in, so that the program finds them wherever it
/// runs.
std::vector<std::pair<std::string, std::string>> const& shipped_glasses();

}  // namespace gladstone
