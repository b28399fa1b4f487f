#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "studies/sweep/results.h"

namespace gladstone {

/// One axis of a study: a key path of the setup and the values that cases take, each once, in the study's order.
struct StudyAxis {
  std::string key;                  ///< "lens.f_number"
  bool numeric = true;              ///< every value is a number
  std::vector<std::string> labels;  ///< every value as text
  std::vector<double> numbers;      ///< in the key's own unit; NaN for what is no number
  bool labelled = false;            ///< numeric, and the study gives a number a label of its own
};

/// One case of a study.
struct StudyRow {
  std::size_t index = 0;
  std::size_t repeat = 0;
  std::uint64_t seed = 0;
  CaseStatus status = CaseStatus::missing;
  std::string error;               ///< of a failed case
  std::vector<std::size_t> value;  ///< for each axis, which of its values
  std::vector<double> measures;    ///< for each of StudyTable::measures; NaN where unknown or the case is not done
  double seconds_render = std::numeric_limits<double>::quiet_NaN();
  double seconds_correlate = std::numeric_limits<double>::quiet_NaN();
  double seconds_compare = std::numeric_limits<double>::quiet_NaN();
  std::string device;
  std::string warning;  ///< the first that it gave; empty: none
  std::string build;    ///< of gladstone that computed it; empty: not done, or unknown
};

/// All repeats of one point of a study.
struct StudyPoint {
  std::vector<std::size_t> rows;    ///< of the table, growing: the repeats, finished or not
  std::vector<RepeatSplit> splits;  ///< by vector_error_names(): of the finished ones
};

/// A study as a table: what figures are drawn from and what study.csv and study.h5 hold.
struct StudyTable {
  std::string name;  ///< of the RUN folder
  std::vector<StudyAxis> axes;
  std::vector<std::string> measures;  ///< "ray_truth.rms_px", "budget.terms.cone.rms_px", "magnification", ...
  std::vector<StudyRow> rows;         ///< every case of the manifest, in its order
  std::vector<StudyPoint> points;     ///< in the order of their first cases

  /// Place of a measure in every row. Nothing where no case has it.
  std::optional<std::size_t> find_measure(std::string_view name) const;
  /// Place of an axis. Nothing where the study has no such axis.
  std::optional<std::size_t> find_axis(std::string_view key) const;
  /// Most repeats of a point.
  std::size_t repeats() const;
  /// The builds of gladstone that computed the rows, each once, sorted.
  std::vector<std::string> builds() const;
  /// The rows that gave warnings.
  std::vector<std::size_t> warned() const;
  /// The rows that are not ok.
  std::vector<std::size_t> unfinished() const;
};

/// Reads the manifest and the results of a RUN; nothing is computed. Cases without a whole result are `missing`.
/// @throws DataError where RUN has no manifest, or a damaged one
StudyTable read_study_table(std::string const& run);

}  // namespace gladstone
