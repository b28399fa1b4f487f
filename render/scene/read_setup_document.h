#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_table.h"

namespace gladstone::inline scene {

/// Reads and parses a setup file (TOML). File names in it are relative to its folder.
/// @param overrides  assignments "KEY=VALUE" that replace keys of the file
/// @throws SetupError if it does not exist, is unreadable, empty or not TOML
SetupDocument read_setup_document(std::string const& path, std::vector<std::string> const& overrides = {});

}  // namespace gladstone::inline scene
