#pragma once

#include <string>
#include <vector>

#include "studies/compare/sequence.h"

namespace gladstone::inline compare {

/// Output folder of a sequence, locked while this object exists so that two runs never write to it at once.
class SequenceFolder {
 public:
  /// Creates the folder if it is missing.
  /// @throws OutputError if it cannot be written, contains files but no sequence.json, or is locked by another run
  explicit SequenceFolder(std::string const& path);
  ~SequenceFolder();
  SequenceFolder(SequenceFolder const&) = delete;
  SequenceFolder& operator=(SequenceFolder const&) = delete;

  /// Returns the path of a file in the folder.
  std::string file(std::string const& name) const;
  /// Creates a folder in the folder if it is missing. @throws OutputError
  void make_folder(std::string const& name) const;

 private:
  void lock();

  std::string path_, lock_path_;
  int lock_ = -1;  ///< descriptor of the locked file .lock
};

/// Removes a file of the folder if it is a damaged HDF5 file, for example one that is cut short, so that it can be
/// replaced; logs a warning.
void remove_damaged_result(std::string const& path);

/// Content of sequence.json besides the pairs.
struct SequenceState {
  Pairing pairing = Pairing::pairs;
  bool complete = false;  ///< true: statistics.h5 includes all pairs that have vectors
  int columns = 0, rows = 0;
  std::string settings, settings_sha256;
};

/// Writes sequence.json. @throws OutputError
void write_sequence_state(std::string const& path, SequenceState const& state, std::vector<PairRecord> const& pairs);

}  // namespace gladstone::inline compare
