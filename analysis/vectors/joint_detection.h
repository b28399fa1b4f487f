#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "analysis/vectors/convention_detection.h"

namespace gladstone::inline vectors {

/// Vectors that a program wrote for one image pair, and the pair's true displacement.
struct VectorsWithTruth {
  VectorFile file;                    ///< vectors in px and screened, see detect_conventions()
  std::function<Vec2d(Vec2d)> truth;  ///< displacement at a position in our conventions [px]
  int image_rows = 0;
};

/// Result of detect_common_conventions().
struct CommonConventions {
  /// Conventions to be used: those of the format's own conventions that fit all files best.
  VectorConventions conventions;
  std::vector<DetectedConventions> detected;  ///< results for the single files, in the order of the files
  /// Mistake that all files have in common; if several are indistinguishable, it has a reason for each of
  /// them and `conventions` is empty.
  ProbableMistake mistake;
  /// Indices of files with an individual mistake: either its correction makes the vectors follow the truth, or they do
  /// not follow the truth at all, although vectors from windows of 64 px would.
  std::vector<std::size_t> mistaken;
  std::size_t decisive = 0;  ///< index of the file with the strongest evidence: for `mistake`, else for `conventions`
  /// True if other axes or signs fit all files about as well as `conventions`; if there is a mistake, true if another
  /// mistake explains the files about as well.
  bool ambiguous = false;
  ConventionFit fit;  ///< agreement of `conventions` with the decisive file
};

/// Determines the conventions that several files of one program have in common, and detects a mistake that they have in
/// common. The evidence of all files is added, so that the result is determined by those files whose displacement
/// distinguishes the interpretations: a uniform displacement is evidence neither for nor against a shift of the
/// positions.
/// - The first of the format's own conventions is used unless the evidence for another of them is larger by at least 9,
///   see log_likelihood_statistic().
/// - A mistake is reported if its evidence exceeds 16 (other axes or signs) or 25 (factor, shift, offset) and its
///   correction reduces the rms difference in the decisive file by 10 or 50 %, respectively. After the correction of a
///   factor, shift or offset, most files must follow the truth, with an rms difference below half the rms of the truth.
/// - Of the interpretations within a tenth of the best evidence, the likeliest is reported first.
/// @pre there is at least one file
CommonConventions detect_common_conventions(std::vector<VectorsWithTruth> const& files);

}  // namespace gladstone::inline vectors
