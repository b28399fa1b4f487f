#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_table.h"

namespace gladstone::python {

/// Setup as given by the user: TOML text and assignments that replace some of its keys.
struct SetupText {
  std::string text;
  std::string name;                    ///< name in messages: the path, or "setup"
  std::string folder;                  ///< directory to which relative file names refer
  std::vector<std::string> overrides;  ///< "key.path=TOML value", applied in this order

  /// @throws SetupError if the text is not TOML
  SetupDocument document() const;
};

}  // namespace gladstone::python
