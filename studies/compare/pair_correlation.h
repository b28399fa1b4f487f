#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "analysis/vectors/track_vectors.h"
#include "render/base/warning.h"
#include "render/files/hdf5_file.h"
#include "render/files/source_files.h"
#include "studies/case/backend.h"
#include "studies/compare/sequence.h"
#include "studies/compare/sequence_images.h"

namespace gladstone::inline compare {

/// Frames next to a pair of consecutive frames, for particle tracks; null: none.
struct PairNeighbours {
  SequenceFrame const* before = nullptr;
  SequenceFrame const* after = nullptr;
};

/// Vectors of the dots or particles of a pair; without vectors unless the method tracks dots.
struct PairDots {
  DisplacementField vectors;
  std::optional<std::vector<std::int64_t>> stored_tracks;  ///< track numbers in the file of an earlier run; nullopt:
                                                           ///< not yet stored
  FileOrigin origin;
};

/// Vectors of a pair.
struct PairVectors {
  DisplacementField field;  ///< vectors without the data that the statistics do not use; empty if the pair failed
  PairDots dots;
};

/// Correlates single pairs of a sequence and stores their vectors. One object serves several threads: while one pair is
/// on a GPU, others are read, assessed and written.
class PairCorrelation {
 public:
  /// @param size              size that all frames must have
  /// @param common_reference  frame A of every pair; nullopt: each pair has its own
  /// @param sources           hashes that all pairs have in common, including "settings"
  /// @param settings          must outlive this object
  PairCorrelation(CorrelationFile const& settings, SequenceSize size, std::optional<SequenceImage> common_reference,
                  SourceFiles sources, Backend device);

  /// Correlates a pair, unless the files contain the vectors of the same frames and settings, and sets its record. A
  /// pair that fails has a record with the reason.
  /// @param path        file of the pair's vectors
  /// @param dots_path   file of the pair's dots, which the caller writes
  /// @param neighbours  frames over which the tracks of its particles extend. One that is unreadable or of another size
  ///                    is not used, and the record contains a warning
  /// @throws Interrupted, OutputError, DeviceError, which concern all pairs
  PairVectors run(PairRecord& record, std::string const& path, std::string const& dots_path,
                  PairNeighbours const& neighbours = {}) const;

 private:
  /// Frames of a pair and, for tracks, those before and after it.
  struct Frames {
    SequenceImage reference, flow;
    std::optional<SequenceImage> before, after;
    Warnings warnings;
  };

  bool tracks_dots() const;
  FileOrigin origin(SourceFiles sources, std::string const& device) const;
  Frames read_frames(PairRecord const& record, PairNeighbours const& neighbours) const;
  /// @return nullopt with a warning if the frame is not suitable
  std::optional<SequenceImage> read_neighbour(SequenceFrame const* frame, Warnings& warnings) const;
  PairVectors correlate(Frames frames, PairRecord& record, std::string const& path) const;
  /// Returns the hashes that a file of vectors records: those in common, and those of the frames.
  SourceFiles hashes(Frames const& frames) const;
  /// Reads the vectors of an earlier run.
  /// @param hashes  hashes of the pair's frames and settings
  /// @return nullopt if they are missing or damaged, or if they belong to other frames or settings
  std::optional<PairVectors> read_finished(std::string const& path, std::string const& dots_path,
                                           SourceFiles const& hashes, PairRecord& record) const;

  CorrelationFile const& settings_;
  SequenceSize size_;
  std::optional<SequenceImage> common_reference_;
  SourceFiles sources_;
  Backend device_;
};

}  // namespace gladstone::inline compare
