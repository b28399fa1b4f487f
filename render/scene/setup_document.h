#pragma once

#include <string>

#include "render/setup/setup_table.h"

namespace gladstone {

/// Reads and parses a setup file (TOML). File names in it are relative to its folder.
/// @throws SetupError if it does not exist, is unreadable, empty or not TOML
SetupDocument read_setup_document(std::string const& path);

}  // namespace gladstone
