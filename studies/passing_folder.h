#pragma once

#include <string>

namespace gladstone {

/// A folder among the temporary ones that is gone with its owner.
class PassingFolder {
 public:
  /// @throws OutputError
  PassingFolder();
  ~PassingFolder();
  PassingFolder(PassingFolder const&) = delete;
  PassingFolder& operator=(PassingFolder const&) = delete;
  std::string const& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace gladstone
