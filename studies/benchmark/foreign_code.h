#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/vectors/convention_detection.h"
#include "studies/benchmark/benchmark_run.h"

namespace gladstone {

/// Vectors of another code for several cases: read as its format says, or as the user tells, with the same conventions
/// for all.
class ForeignCode {
 public:
  /// Finds the files of these cases. @throws DataError where there is none
  ForeignCode(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases);

  std::string const& name() const { return name_; }
  bool has(std::string const& of_case) const { return files_.contains(of_case); }

  /// The vectors of a case in our conventions. Of several readings that are the format's own the first file tells
  /// which.
  /// @throws DataError where they cannot be scored: see BenchmarkResult, and refusal_of_gaps()
  DisplacementField read(std::string const& of_case, DisplacementAt const& truth, int columns, int rows);

  /// How the files were read, in words; empty where they are ours.
  std::string const& reading() const { return reading_; }
  /// What the files that were read say is wrong with them, all together: the case that can tell decides. Empty:
  /// nothing.
  std::string mistake() const;

 private:
  std::string name_;
  std::map<std::string, std::string> files_;  ///< by case
  std::optional<std::string> told_;
  std::optional<VectorConventions> conventions_;
  std::vector<VectorConventions> own_;  ///< every reading that is the format's own
  std::string reading_;
  std::vector<std::pair<std::string, DetectedConventions>> detected_;  ///< by case
};

/// Why vectors are not the whole grid that a case is scored on: nodes without a vector, between others or further from
/// the border than 96 px, where windows of 128 px reach. Empty where it is whole.
std::string refusal_of_gaps(DisplacementField const& field, int columns, int rows);

}  // namespace gladstone
