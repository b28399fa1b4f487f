#pragma once

#include <filesystem>

namespace gladstone::inline files {

/// Returns true if a folder contains visible files or folders, whose names do not start with a dot.
bool contains_visible_files(std::filesystem::path const& folder);

}  // namespace gladstone::inline files
