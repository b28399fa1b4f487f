#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/vectors/joint_detection.h"
#include "studies/benchmark/benchmark_run.h"

namespace gladstone::inline benchmarks {

/// Finds the vector files of an external code: paths by the name of their case.
/// @throws DataError if the folder contains no such file
std::map<std::string, std::string> find_vectors(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases);

/// Vectors of external software for several cases, all interpreted by the same conventions: those of the user or, if
/// none are given, those of the format. If the format has several possible conventions, all cases together decide.
class ForeignCode {
 public:
  /// @throws the exceptions of find_vectors()
  ForeignCode(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases);

  std::string const& name() const { return name_; }

  /// Reads the vectors of a case, if there are any.
  /// @throws DataError if they cannot be scored, see run_benchmark()
  void read(std::string const& of_case, DisplacementAt const& truth, int columns, int rows);
  /// Determines the conventions from all vectors that were read, and scores them.
  /// @throws DataError if no conventions fit, or for the reason of reason_to_reject_gaps()
  std::vector<BenchmarkRow> score();

  /// Returns a description of the conventions; empty for files of gladstone.
  std::string const& reading() const { return reading_; }
  /// Returns what is probably wrong with the files, a line each: a mistake that they have in common, a code whose
  /// vectors hardly follow the truth, and files whose header declares another number of vectors.
  std::vector<std::string> const& mistakes() const { return mistakes_; }

 private:
  struct Case {
    std::string name, path;
    int columns = 0;
  };
  std::string describe_mistakes(CommonConventions const& common) const;

  std::string name_;
  std::map<std::string, std::string> files_;  ///< file names by case
  std::optional<std::string> told_;
  std::vector<Case> cases_;
  std::vector<VectorsWithTruth> vectors_;  ///< vectors of each case
  std::string reading_;
  std::vector<std::string> mistakes_;
};

/// Returns the reason why vectors do not cover the grid on which a case is scored: missing nodes between others, or no
/// nodes up to 96 px from the border, which windows of 128 px reach. Returns an empty string if the grid is complete or
/// the vectors are scattered.
std::string reason_to_reject_gaps(DisplacementField const& field, int columns, int rows);

}  // namespace gladstone::inline benchmarks
