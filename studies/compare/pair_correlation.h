#pragma once

#include <optional>
#include <string>

#include "analysis/vectors/displacement_field.h"
#include "render/files/source_files.h"
#include "studies/case/backend.h"
#include "studies/compare/sequence.h"
#include "studies/compare/sequence_images.h"

namespace gladstone {

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

  /// Correlates a pair, unless the file contains the vectors of the same frames and settings, and sets its record. A
  /// pair that fails has a record with the reason.
  /// @param path  file of its vectors
  /// @return its vectors without the data that the statistics do not use; empty if it failed
  /// @throws Interrupted, OutputError, DeviceError, which concern all pairs
  DisplacementField run(PairRecord& record, std::string const& path) const;

 private:
  DisplacementField measure(PairRecord& record, std::string const& path) const;
  DisplacementField correlate(SequenceImage reference, SequenceImage flow, PairRecord& record,
                              std::string const& path) const;
  /// Reads the vectors of an earlier run.
  /// @return nullopt if they are missing or damaged, or if they belong to other frames or settings
  std::optional<DisplacementField> read_finished(std::string const& path, PairRecord& record) const;

  CorrelationFile const& settings_;
  SequenceSize size_;
  std::optional<SequenceImage> common_reference_;
  SourceFiles sources_;
  Backend device_;
};

}  // namespace gladstone
