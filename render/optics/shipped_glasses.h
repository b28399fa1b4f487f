#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gladstone {

/// Name and text of every catalogue in data/glasses. The texts are built in, so that the program finds them wherever it
/// runs.
std::vector<std::pair<std::string, std::string_view>> const& shipped_glasses();

}  // namespace gladstone
