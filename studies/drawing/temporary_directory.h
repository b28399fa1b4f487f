#pragma once

#include <optional>
#include <string>

#include "render/files/partial.h"

namespace gladstone::inline drawing {

/// Unique temporary directory, readable by this user only; removed on destruction. Directories left by killed processes
/// of this user are removed when the next one is created in the same place (TMPDIR).
class TemporaryDirectory {
 public:
  /// @throws OutputError if no directory can be created
  TemporaryDirectory();
  std::string const& path() const { return path_; }

 private:
  std::optional<Partial> partial_;
  std::string path_;
};

}  // namespace gladstone::inline drawing
