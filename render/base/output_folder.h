#pragma once

#include <functional>
#include <optional>
#include <string>

#include "render/base/folder_replacement.h"
#include "render/base/output_place.h"
#include "render/base/partial.h"

namespace gladstone {

/// A folder of files that belong together, which exist all or not at all. Where no folder stands, it is built beside
/// its place and renamed when whole. A folder that is there stays itself (it may be where a shell stands, a mount, or
/// shared with other rights): new files are made in a partial folder inside it and replace the old ones at commit(), as
/// replace_files() does. What a user put there stays: everything but the files that are written anew and those derived
/// from them.
class OutputFolder {
 public:
  /// Tries the place before anything is computed, and completes a replacement that was broken off there.
  /// @throws OutputError where it cannot be written, is a file, or holds data that gladstone did not write (has files,
  ///         but none with the marker's name)
  OutputFolder(std::string const& path, FolderContent content);
  ~OutputFolder();
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;

  /// The folder to write into until commit().
  std::string const& temporary_path() const { return staged_; }
  /// Calls `write` with it; what cannot be written is named by its final place.
  void fill(std::function<void(std::string const& folder)> const& write) const;
  /// @throws OutputError with the old files in their places
  void commit();

 private:
  void stage(std::string const& parent, std::string const& stem);
  void refuse_foreign_folder() const;

  OutputPlace place_;
  FolderContent content_;
  std::optional<Partial> partial_;
  std::string staged_;
  bool committed_ = false;
};

}  // namespace gladstone
