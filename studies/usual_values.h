#pragma once

#include <string>
#include <vector>

#include "render/base/setup_table.h"

namespace gladstone {

/// Values of a setup that lie outside what laboratories use, one text each: its place, the usual range and the unit
/// that would bring it there. Only keys that are written in the file are looked at; zero and infinity are no slips.
std::vector<std::string> unusual_values(SetupDocument& document);

}  // namespace gladstone
