#pragma once

#include <functional>
#include <optional>
#include <string>

#include "render/files/folder_replacement.h"
#include "render/files/output_destination.h"
#include "render/files/partial.h"

namespace gladstone::inline files {

/// Output directory of files that belong together: either all of them exist or none. A new directory is built under a
/// temporary name next to its final place and renamed when complete. An existing directory is retained (it may be a
/// working directory, a mount point, or have its own permissions): new files are written to a partial directory inside
/// it and moved by replace_files() in commit(). Of the existing files only those that are written again, and those
/// derived from them, are replaced or removed.
class OutputFolder {
 public:
  /// Creates the temporary directory, so that an unusable output is reported before any computation, and completes an
  /// interrupted replacement in the directory.
  /// @throws OutputError if it is not writable, is a file, or contains files that gladstone did not write (no marker
  ///         file)
  OutputFolder(std::string const& path, FolderContent content);
  ~OutputFolder();
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;

  /// Path of the temporary directory, to be filled before commit().
  std::string const& temporary_path() const { return staged_; }
  /// Calls `write` with the temporary directory; an OutputError names the final path instead of the temporary one.
  void fill(std::function<void(std::string const& folder)> const& write) const;
  /// Moves the files to their final place. @throws OutputError with the old files restored
  void commit();

 private:
  void stage(std::string const& parent, std::string const& stem);
  void refuse_foreign_folder() const;

  OutputDestination place_;
  FolderContent content_;
  std::optional<Partial> partial_;
  std::string staged_;
  bool committed_ = false;
};

}  // namespace gladstone::inline files
