#pragma once

#include <string>

struct stat;

namespace gladstone {

/// Protects the input files of a command: while an object of this class exists, the process records every file that it
/// opens for reading (InputFile), and OutputFile and OutputFolder refuse to replace any of them. Files that the process
/// itself has written are no inputs. Made once, by main; without it nothing is recorded.
class InputGuard {
 public:
  InputGuard();
  ~InputGuard();
  InputGuard(InputGuard const&) = delete;
  InputGuard& operator=(InputGuard const&) = delete;
};

/// RAII: files that this thread opens are not recorded, because the command reads them in order to replace them.
class UnguardedReading {
 public:
  UnguardedReading();
  ~UnguardedReading();
  UnguardedReading(UnguardedReading const&) = delete;
  UnguardedReading& operator=(UnguardedReading const&) = delete;
};

/// Records a file that has been opened for reading.
void record_input(std::string const& path, struct stat const& file);

/// Records a file that the process has written.
void record_output(int descriptor);

/// @param path   file that an output is about to replace or remove
/// @param asked  its name for messages
/// @throws OutputError where it is a recorded input, under whatever name, also through links or as another hard link
void refuse_recorded_input(std::string const& path, std::string const& asked);

}  // namespace gladstone
