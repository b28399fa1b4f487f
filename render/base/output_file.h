#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone {

/// A file written beside its place (as ".NAME.partial-PID") and renamed when it is whole, so that what exists is whole
/// and an interrupted overwrite leaves the old one. The destructor removes what was not committed; what a killed run
/// left behind is removed when the same file is written again.
class OutputFile {
 public:
  /// Makes the folder where it is missing, and an empty temporary file, so that what cannot be written is known early.
  /// A link is followed. @throws OutputError where the folder cannot be written, or `path` is a folder or a device
  explicit OutputFile(std::string const& path);
  ~OutputFile();
  OutputFile(OutputFile const&) = delete;
  OutputFile& operator=(OutputFile const&) = delete;

  /// Where to write until commit().
  std::string const& temporary_path() const { return temporary_; }
  /// Writes the whole content at once; alternatively write to temporary_path(). @throws OutputError
  void write(void const* data, std::size_t size);
  /// Flushes to disk (fsync) and renames. @throws OutputError (full disk, ...)
  void commit();

  /// Writes text as one whole file.
  static void write_text(std::string const& path, std::string const& text);

 private:
  std::string path_;
  std::string temporary_;
  std::vector<std::string> made_folders_;  ///< removed again, where empty, if nothing is committed
  bool committed_ = false;
};

/// A folder built beside its place and renamed when whole; an old folder of that name is replaced only then, and only
/// if it is empty or was made by gladstone (holds `marker_file`). What a user put into the old one moves to the new
/// one: everything but the files that are written anew and those derived from them, so that no user's data are lost.
class OutputFolder {
 public:
  /// @param derived names of files that make no sense beside new ones; they go with the old folder
  /// @throws OutputError where it cannot be made, `path` is a file, or holds data that gladstone did not write
  OutputFolder(std::string const& path, std::string marker_file, std::vector<std::string> derived = {});
  ~OutputFolder();
  OutputFolder(OutputFolder const&) = delete;
  OutputFolder& operator=(OutputFolder const&) = delete;

  /// The folder to write into until commit().
  std::string const& temporary_path() const { return temporary_; }
  void commit();

 private:
  std::string path_;
  std::string temporary_;
  std::string marker_file_;
  std::vector<std::string> derived_;
  std::vector<std::string> made_folders_;
  bool committed_ = false;
};

}  // namespace gladstone
