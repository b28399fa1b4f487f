#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/vectors/sequence_statistics.h"
#include "render/base/warning.h"
#include "studies/case/backend.h"
#include "studies/compare/correlate.h"
#include "studies/compare/sequence_frames.h"

namespace gladstone::inline compare {

/// File names in the output folder of a sequence, besides the vectors of each pair.
namespace sequence_file {
inline constexpr char const* state = "sequence.json";
inline constexpr char const* statistics = "statistics.h5";
inline constexpr char const* figure = "statistics.png";
/// Folder of the scattered vectors of tracked dots, one file per pair with the name of its vectors.
inline constexpr char const* dots = "dots";
}  // namespace sequence_file

/// Settings of a sequence.
struct SequenceSettings {
  Pairing pairing = Pairing::pairs;
  CorrelationFile correlation;  ///< correlation settings for PreparedSet::sequence; correlate_sequence() computes the
                                ///< backgrounds
};
/// Reads the settings of a sequence like read_correlation_file(), or like default_correlation() if `path` is empty, but
/// "background" steps may omit `frame`, and then subtract the background of the sequence.
/// @throws SetupError; DataError if the vectors would not be on a grid
SequenceSettings read_sequence_settings(Pairing pairing, std::string const& path,
                                        std::vector<std::string> const& overrides);

/// Progress of a pair, as stored in sequence.json.
enum class PairState { pending, done, no_valid_vector, failed };

/// Pair of a sequence with its result.
struct PairRecord {
  SequencePair pair;
  PairState state = PairState::pending;
  bool resumed = false;  ///< the vectors of the pair were computed by an earlier run
  std::string error;     ///< reason of the state `failed` or `no_valid_vector`
  std::string reference_sha256, flow_sha256;
  Warnings warnings;

  bool has_vectors() const { return state == PairState::done || state == PairState::no_valid_vector; }
};

/// Result of correlate_sequence().
struct SequenceResult {
  std::vector<PairRecord> pairs;
  std::string device;
  double seconds = 0;          ///< wall time [s]
  SequenceMoments statistics;  ///< without points if no pair has vectors
  Warnings warnings;           ///< about several pairs at once, or about the statistics

  std::size_t vectors() const { return statistics.position_px.size(); }  ///< vectors per field; 0: no field
  /// Counts the pairs of a state, and those with vectors of an earlier run.
  std::size_t count(PairState state) const;
  std::size_t count_resumed() const;
};

/// Correlates the pairs of a sequence, thread_count() of them at a time, and writes the folder: the vectors of each
/// pair as soon as it is done, then statistics.h5 and sequence.json.
/// - A pair that fails does not affect the others; its record contains the reason.
/// - All frames must have the commonest size; pairs with another one fail.
/// - Vectors in the folder with the hashes of these frames and settings are read instead of computed again, so that the
///   same call continues an interrupted run. Those of a damaged file are computed again, with a warning.
/// - With Pairing::consecutive, tracking uses the frames before and after a pair as well.
/// - The scattered vectors of tracked dots are stored in the folder `dots`, with the numbers of their tracks if the
///   pairs have frames in common (tracking::TrackNumbers).
/// - At most thread_count() pairs of frames, with their neighbours for tracking, are in memory, besides backgrounds,
///   the sums of the statistics and a few fields that wait to be added to them.
/// @param show_progress  report the progress on stderr
/// @throws DataError if no frame is readable, or the frames are smaller than a window; OutputError; DeviceError;
///         Interrupted, with the finished pairs stored
SequenceResult correlate_sequence(std::vector<SequencePair> const& pairs, SequenceSettings const& settings,
                                  std::string const& folder, Backend device, bool show_progress);

/// Logs the warnings of a result: each pair without valid vectors (at most 20, and the number of the others), and
/// SequenceResult::warnings.
/// @param folder  output folder, for the error
/// @throws DataError if no pair has a valid vector
void report_sequence(SequenceResult const& result, std::string const& folder);

}  // namespace gladstone::inline compare
