#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// What a measured vector is worth; the numbers are those of vectors.h5 and vectors.csv.
enum class VectorStatus : int { valid = 0, replaced = 1, masked = 2, invalid = 3 };

/// How a vector came to be what it is; the numbers are those of vectors.h5 and vectors.csv.
enum class VectorReason : int {
  measured = 0,      ///< valid: as measured
  other_peak = 1,    ///< replaced by another peak of its window, since it failed a test
  neighbours = 2,    ///< replaced by its neighbours' median, since it failed a test
  masked = 3,        ///< half the window unknown
  no_signal = 4,     ///< invalid: nothing in the window to correlate
  not_replaced = 5,  ///< invalid: failed a test, and is not replaced or has too few sound neighbours for it
  beyond_limit = 6,  ///< invalid: no peak within the search range, or the largest displacement that was allowed
  uncorrelated = 7,  ///< invalid: no better than what windows give that have nothing in common
  outside = 8,       ///< invalid: the displacement around takes half the window or more out of a frame
};

/// The test that a replaced vector, or one not_replaced, has failed; the numbers are those of vectors.h5.
enum class FailedTest : std::uint8_t {
  none = 0,
  median = 1,        ///< what its pass added is unlike its neighbours', or the whole where some are missing
  displacement = 2,  ///< the whole is, and it correlates worse
  peak_ratio = 3,    ///< another peak is nearly as high
  correlation = 4,   ///< its peak is low
};

/// Whether another displacement fits (nearly) as well as a measured one. Files say 0 or 1.
enum class Ambiguity : std::uint8_t {
  none = 0,
  here = 1,     ///< one does
  earlier = 2,  ///< one did for the larger windows of an earlier pass, which this one started from
};

/// Displacements at scattered or gridded points: one type for truth, theory and measurement.
/// Positions and displacements in px; column x to the right, row y downwards, displacement = flow - reference.
struct DisplacementField {
  std::vector<Vec2d> position_px;
  std::vector<Vec2d> displacement_px;
  std::vector<Vec2d> sigma_px;       ///< standard uncertainty, NaN where not estimated; empty: none
  std::vector<double> peak_ratio;    ///< highest over second correlation peak; empty: none
  std::vector<VectorStatus> status;  ///< empty: all valid
  std::vector<Vec2d> raw_px;         ///< before replacement; NaN where nothing was measured; empty: not known
  std::vector<double> correlation;   ///< coefficient of the peak that raw_px is, NaN as there; empty: not known
  std::vector<VectorReason> reason;  ///< empty: not known
  std::vector<FailedTest> failed;    ///< empty: not known
  std::vector<Ambiguity> ambiguous;  ///< empty: not known
  int columns = 0;                   ///< vectors in a row of the interrogation grid, row by row; 0: scattered
  int rows = 0;
  std::vector<std::string> warnings;  ///< about the measurement as a whole
  /// "correlates", "does not correlate" or "not judged: REASON"; empty: nobody was asked.
  std::string verdict;

  std::size_t size() const { return position_px.size(); }
  /// True for vectors that count in statistics (valid or replaced).
  bool counts(std::size_t i) const {
    return status.empty() || status[i] == VectorStatus::valid || status[i] == VectorStatus::replaced;
  }
};

}  // namespace gladstone
