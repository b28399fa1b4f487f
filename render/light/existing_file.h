#pragma once

#include <filesystem>
#include <string>

#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Reads the key `file` of a table and checks that the file exists.
inline std::string existing_file(SetupTable& table) {
  std::string const file = table.required_path("file");
  if (std::error_code error; !file.empty() && !std::filesystem::exists(file, error)) {
    table.problem("file", "file not found: " + file + "; relative names are resolved against the setup file's folder",
                  ErrorCode::missing_file);
  }
  return file;
}

}  // namespace gladstone::inline light
