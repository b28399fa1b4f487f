#pragma once

#include <string>
#include <vector>

struct stat;

namespace gladstone::inline files {

/// Files of a folder of results that only the command which makes the folder may write.
struct ProtectedFiles {
  std::string what;                  ///< description for messages, e.g. "study"
  std::vector<std::string> markers;  ///< entries that all folders of this kind have
  std::vector<std::string> names;    ///< paths in the folder, at most one level deep; one * matches any characters
};

/// Protects the input files of a command and the files of other results from being overwritten. While an object of this
/// class exists, the process records every file that it opens for reading (InputFile), and OutputFile and OutputFolder
/// refuse to replace any of them. Files written by the process itself are not inputs. Created once, by main(); without
/// it, no file is recorded or protected.
class InputGuard {
 public:
  /// @param results  files that OutputFile refuses to write, see refuse_protected_file()
  explicit InputGuard(std::vector<ProtectedFiles> results = {});
  ~InputGuard();
  InputGuard(InputGuard const&) = delete;
  InputGuard& operator=(InputGuard const&) = delete;
};

/// RAII guard: files that this thread opens are not recorded as inputs. For files that are read in order to be
/// replaced.
class UnrecordedReading {
 public:
  UnrecordedReading();
  ~UnrecordedReading();
  UnrecordedReading(UnrecordedReading const&) = delete;
  UnrecordedReading& operator=(UnrecordedReading const&) = delete;
};

/// RAII guard: this thread may write protected files. For the commands that make the folders of results.
class ProtectedWritePermit {
 public:
  ProtectedWritePermit();
  ~ProtectedWritePermit();
  ProtectedWritePermit(ProtectedWritePermit const&) = delete;
  ProtectedWritePermit& operator=(ProtectedWritePermit const&) = delete;
};

/// Records a file that has been opened for reading.
void record_input(std::string const& path, struct stat const& file);

/// Records a file that the process has written.
void record_output(int descriptor);

/// Throws if a file to be replaced is a recorded input, under any name: also through links or as another hard link.
/// @param path   file that an output would replace or remove
/// @param asked  name of the output for messages
/// @throws OutputError if the file is a recorded input
void refuse_recorded_input(std::string const& path, std::string const& asked);

/// Throws if a file belongs to a folder of results (ProtectedFiles), whether it exists or not.
/// @param path   file to be written, absolute and without links
/// @param asked  name of the output for messages
/// @throws OutputError if the file is protected and no ProtectedWritePermit exists in this thread
void refuse_protected_file(std::string const& path, std::string const& asked);

}  // namespace gladstone::inline files
