#pragma once

#include <optional>
#include <string>

#include "render/base/partial.h"

namespace gladstone {

/// Unique temporary folder, which only this user can read; removed on destruction. What killed processes of this user
/// left is removed when the next one is made in the same place (TMPDIR).
class PassingFolder {
 public:
  /// @throws OutputError
  PassingFolder();
  std::string const& path() const { return path_; }

 private:
  std::optional<Partial> partial_;
  std::string path_;
};

}  // namespace gladstone
