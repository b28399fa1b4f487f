#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "render/files/output_destination.h"
#include "render/files/partial.h"

namespace gladstone::inline files {

/// Output file that is written under a temporary name (Partial) and renamed when complete: no incomplete file is ever
/// visible, and an interrupted write preserves the old file. The destructor removes an uncommitted file; temporary
/// files of killed processes are removed when the same output is written again.
class OutputFile {
 public:
  /// Creates missing parent directories and an empty temporary file, so that an output that cannot be written is
  /// reported before any computation. Symbolic links are followed.
  /// @param kind  kind of the new content, as file_kind() returns it; if empty, only commit() compares the kinds
  /// @throws OutputError if the directory is not writable; if `path` is a directory, a device, a mount point or an
  ///         input of the command or a file of other results (InputGuard); if `path` contains data of another known
  ///         kind
  explicit OutputFile(std::string const& path, std::string const& kind = "");
  ~OutputFile();
  OutputFile(OutputFile const&) = delete;
  OutputFile& operator=(OutputFile const&) = delete;

  /// Path of the temporary file, to be written before commit().
  std::string const& temporary_path() const { return partial_->path(); }
  /// Writes the whole content at once, in place of writing to temporary_path(). @throws OutputError
  void write(void const* data, std::size_t size);
  /// Flushes the file to disk (fsync) and renames it; a replaced file's permissions are retained.
  /// @throws OutputError if the disk is full, or the file to be replaced has been read meanwhile or is of another kind
  void commit();

  /// Writes a text file; it appears under its name when complete.
  static void write_text(std::string const& path, std::string const& text);

 private:
  void refuse_replacing(std::string const& kind) const;

  OutputDestination place_;
  std::optional<Partial> partial_;
  bool committed_ = false;
};

/// Flushes a file, or a directory's entries, to disk. @return 0 or errno
int flush_to_disk(std::string const& path);

}  // namespace gladstone::inline files
