#pragma once

#include <string>

struct stat;

namespace gladstone {

/// Protects the input files of a command from being overwritten. While an object of this class exists, the process
/// records every file that it opens for reading (InputFile), and OutputFile and OutputFolder refuse to replace any of
/// them. Files written by the process itself are not inputs. Created once, by main(); without it, no file is recorded.
class InputGuard {
 public:
  InputGuard();
  ~InputGuard();
  InputGuard(InputGuard const&) = delete;
  InputGuard& operator=(InputGuard const&) = delete;
};

/// RAII guard: files that this thread opens are not recorded as inputs. For files that are read in order to be
/// replaced.
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

/// Throws if a file to be replaced is a recorded input, under any name: also through links or as another hard link.
/// @param path   file that an output would replace or remove
/// @param asked  name of the output for messages
/// @throws OutputError if the file is a recorded input
void refuse_recorded_input(std::string const& path, std::string const& asked);

}  // namespace gladstone
