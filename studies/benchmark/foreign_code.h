#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/vectors/convention_detection.h"
#include "studies/benchmark/benchmark_run.h"

namespace gladstone {

/// Finds the vector files of an external code: paths by the name of their case.
/// @throws DataError if there are none
std::map<std::string, std::string> find_vectors(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases);

/// Vectors of external software for several cases, all interpreted by the same conventions: those of the user or, if
/// none are given, those of the format.
class ForeignCode {
 public:
  /// @throws the exceptions of find_vectors()
  ForeignCode(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases);

  std::string const& name() const { return name_; }
  bool has(std::string const& of_case) const { return files_.contains(of_case); }

  /// Reads the vectors of a case and converts them to our conventions. If the format has several possible conventions,
  /// the first file that is read determines them.
  /// @throws DataError if the vectors cannot be scored, see run_benchmark() and refusal_of_gaps()
  DisplacementField read(std::string const& of_case, DisplacementAt const& truth, int columns, int rows);

  /// Returns a description of the conventions; empty for files of gladstone.
  std::string const& reading() const { return reading_; }
  /// Returns the probable mistake in the files read so far, or an empty string. The evidence of all cases is combined,
  /// so that the cases that distinguish the conventions decide.
  std::string mistake() const;
  /// Returns a line for each file read so far whose header declares another number of vectors.
  std::vector<std::string> const& incomplete() const { return incomplete_; }

 private:
  std::string name_;
  std::map<std::string, std::string> files_;  ///< file names by case
  std::optional<std::string> told_;
  std::optional<VectorConventions> conventions_;
  std::vector<VectorConventions> own_;  ///< all conventions that the format allows
  std::string reading_;
  std::vector<std::string> incomplete_;
  std::vector<std::pair<std::string, DetectedConventions>> detected_;  ///< results by case
};

/// Returns the reason why vectors do not cover the grid on which a case is scored: missing nodes between others, or no
/// nodes up to 96 px from the border, which windows of 128 px reach. Returns an empty string if the grid is complete or
/// the vectors are scattered.
std::string refusal_of_gaps(DisplacementField const& field, int columns, int rows);

}  // namespace gladstone
