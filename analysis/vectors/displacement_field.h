#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/vectors/pair_verdict.h"
#include "render/base/vec.h"
#include "render/base/warning.h"

namespace gladstone::inline vectors {

/// Validity of a measured vector. The values are stored in vectors.h5 and vectors.csv.
enum class VectorStatus : int { valid = 0, replaced = 1, masked = 2, invalid = 3 };

/// Origin of a vector, or the reason why it is missing. The values are stored in vectors.h5 and vectors.csv.
enum class VectorReason : int {
  measured = 0,      ///< valid: displacement of the selected correlation peak
  other_peak = 1,    ///< replaced by a secondary correlation peak, after a failed validation test
  neighbours = 2,    ///< replaced by the median of its neighbours, after a failed validation test
  masked = 3,        ///< masked: the valid pixels carry less than half of the window's weight
  no_signal = 4,     ///< invalid: no signal in the window
  not_replaced = 5,  ///< invalid: failed a validation test; replacement is off, or too few neighbours are valid
  beyond_limit = 6,  ///< invalid: no peak within the search range or below the maximum displacement
  uncorrelated = 7,  ///< invalid: the correlation is no better than that of unrelated windows (decorrelation test)
  outside = 8,       ///< invalid: the local displacement moves half of the window or more out of a frame
};

/// Validation test that a replaced vector, or one of reason `not_replaced`, failed. The values are stored in
/// vectors.h5.
enum class FailedTest : std::uint8_t {
  none = 0,
  /// Normalised median test of the increment of the last pass (at the grid's rim also of the displacement).
  median = 1,
  displacement = 2,  ///< median test of the total displacement, combined with a lower correlation than the neighbours
  peak_ratio = 3,    ///< peak ratio below its threshold
  correlation = 4,   ///< correlation coefficient below its threshold
};

/// Ambiguity of a measured vector: a second displacement correlates (nearly) as well. Files store 0 (none) or 1.
enum class Ambiguity : std::uint8_t {
  none = 0,
  here = 1,     ///< secondary peak of nearly the same height in this pass
  earlier = 2,  ///< secondary peak of nearly the same height in an earlier pass with larger windows, from which the
                ///< predictor of this pass was computed
};

/// Displacements at scattered points or on a grid; used for ground truth, theory and measurements. Positions and
/// displacements are in px, column x to the right, row y downwards. The displacement is that from frame A to frame B
/// (in BOS: from the reference image to the measurement image).
struct DisplacementField {
  std::vector<Vec2d> position_px;
  std::vector<Vec2d> displacement_px;
  std::vector<Vec2d> sigma_px;       ///< standard uncertainty [px]; NaN or empty: not estimated
  std::vector<double> peak_ratio;    ///< ratio of the highest to the second correlation peak [1]; empty: not measured
  std::vector<VectorStatus> status;  ///< validity of each vector; empty: all valid
  std::vector<Vec2d> raw_px;         ///< displacement before replacement [px]; NaN or empty: none
  std::vector<double> correlation;   ///< correlation coefficient of the peak at raw_px [1]; NaN or empty: none
  std::vector<VectorReason> reason;  ///< source of each displacement, or why it is missing; empty: not recorded
  std::vector<FailedTest> failed;    ///< validation test that each vector failed; empty: not recorded
  std::vector<Ambiguity> ambiguous;  ///< ambiguity of each vector; empty: not recorded
  /// Number of columns of the grid, whose vectors are stored row by row; 0: scattered points.
  int columns = 0;
  int rows = 0;
  Warnings warnings;      ///< warnings about the measurement as a whole
  PairVerdict verdict{};  ///< whether the frames correlate
  /// Method that estimated sigma_px: a value of correlate.uncertainty, or "dot_fit" for tracked dots; empty: unknown.
  std::string uncertainty_method;
  /// Key that selected the method, e.g. `correlate.uncertainty = "auto"`, see record_uncertainty(); empty: unknown.
  std::string uncertainty_key;

  std::size_t size() const { return position_px.size(); }
  /// Returns true if the vector is included in statistics (valid or replaced).
  bool counts(std::size_t i) const {
    return status.empty() || status[i] == VectorStatus::valid || status[i] == VectorStatus::replaced;
  }
};

}  // namespace gladstone::inline vectors
