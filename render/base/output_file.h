#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "render/base/output_place.h"
#include "render/base/partial.h"

namespace gladstone {

/// A file written beside its place (as a Partial) and renamed when it is whole, so that what exists is whole and an
/// interrupted overwrite leaves the old one. The destructor removes what was not committed; what a killed run left
/// behind is removed when the same file is written again.
class OutputFile {
 public:
  /// Makes the folder where it is missing, and an empty temporary file, so that what cannot be written is known before
  /// anything is computed. A link is followed.
  /// @param kind of what will be written, as file_kind() names it; empty: commit() looks
  /// @throws OutputError where the folder cannot be written; where `path` is a folder, a device, a mount of its own, an
  ///         input of the command (InputGuard), or holds a file of another kind that file_kind() knows
  explicit OutputFile(std::string const& path, std::string const& kind = "");
  ~OutputFile();
  OutputFile(OutputFile const&) = delete;
  OutputFile& operator=(OutputFile const&) = delete;

  /// Where to write until commit().
  std::string const& temporary_path() const { return partial_->path(); }
  /// Writes the whole content at once; alternatively write to temporary_path(). @throws OutputError
  void write(void const* data, std::size_t size);
  /// Flushes to disk (fsync) and renames; the rights of a file that it replaces stay.
  /// @throws OutputError (full disk; the file to be replaced has been read since, or is of another kind)
  void commit();

  /// Writes text as one whole file.
  static void write_text(std::string const& path, std::string const& text);

 private:
  void refuse_replacing(std::string const& kind) const;

  OutputPlace place_;
  std::optional<Partial> partial_;
  bool committed_ = false;
};

/// Flushes a file, or a folder's entries, to disk. @return 0 or errno
int flush_to_disk(std::string const& path);

}  // namespace gladstone
