#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/warning.h"
#include "studies/sweep/results.h"

namespace gladstone::inline sweep {

/// Axis of a study: a key path of the setup and its distinct values, in the study's order.
struct StudyAxis {
  std::string key;                  ///< "lens.f_number"
  bool numeric = true;              ///< every value is a number
  std::vector<std::string> labels;  ///< all values as text
  std::vector<double> numbers;      ///< values in the unit of the key; NaN if not a number
  bool labelled = false;            ///< numeric, and the study file defines labels for some numbers
};

/// One case of a study. A table holds all of them: besides its measures, a row should take little memory.
struct StudyRow {
  std::size_t index = 0;
  std::size_t repeat = 0;
  std::uint64_t seed = 0;
  CaseStatus status = CaseStatus::missing;
  bool on_gpu = false;             ///< the case was planned for "cuda", not for "cpu"
  bool warned = false;             ///< the case has warnings
  std::string error;               ///< error message of a failed case
  std::vector<std::size_t> value;  ///< [axes] index of the value of each axis
  /// [StudyTable::measures] values of the measures; NaN if unknown or the case is not finished
  std::vector<double> measures;
  double seconds_render = std::numeric_limits<double>::quiet_NaN();
  double seconds_correlate = std::numeric_limits<double>::quiet_NaN();
  double seconds_compare = std::numeric_limits<double>::quiet_NaN();

  char const* device() const { return on_gpu ? "cuda" : "cpu"; }
};

/// All repeats of one point of a study.
struct StudyPoint {
  std::vector<std::size_t> rows;  ///< row indices of the repeats, finished or not, in ascending order
  /// Error statistics of the finished repeats, in the order of vector_error_names(); empty in a study without repeats.
  std::vector<RepeatSplit> splits;
};

/// Table of a study: source of its figures, study.csv and study.h5.
struct StudyTable {
  std::string name;  ///< name of the RUN folder
  std::vector<StudyAxis> axes;
  std::vector<std::string> measures;     ///< "ray_truth.rms_px", "budget.terms.cone.rms_px", "magnification", ...
  std::vector<StudyRow> rows;            ///< all cases of the manifest, in its order
  std::vector<StudyPoint> points;        ///< in the order of their first cases
  std::vector<std::string> builds;       ///< distinct builds of gladstone that computed the cases, sorted
  std::optional<Warning> first_warning;  ///< first warning of the first case with warnings

  /// Returns the index of a measure in every row, or nullopt if no case has it.
  std::optional<std::size_t> find_measure(std::string_view name) const;
  /// Returns the largest number of repeats of a point.
  std::size_t repeats() const;
  /// Returns the rows with warnings.
  std::vector<std::size_t> warned() const;
  /// Returns the rows whose status is not ok.
  std::vector<std::size_t> unfinished() const;
};

/// Reads manifest and results of a RUN folder without computing anything. Cases without an intact result are `missing`.
/// @throws DataError if RUN has no manifest or a damaged one
StudyTable read_study_table(std::string const& run);

}  // namespace gladstone::inline sweep
