#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "studies/sweep/manifest.h"
#include "studies/sweep/study_file.h"

namespace gladstone::inline sweep {

/// All cases of a study, generated on access. The order has repeats outermost and, in a grid, the last axis fastest, so
/// that neighbouring cases share most intermediate results. The seeds of target, pupil and noise depend only on the
/// study's seed and the repeat, unless an axis specifies them.
class StudyPlan {
 public:
  /// Checks values of all axes by loading complete setups. Each value of an axis is combined with the first values of
  /// the other axes (zip: all pairs); of a range in sobol mode, both ends and one sample are checked. If there are more
  /// than most_tried, evenly spaced ones are checked. Problems of other combinations only appear in the run.
  /// @param device  "cpu" or "cuda"
  /// @throws SetupError at positions in the study file and the base setup
  StudyPlan(StudyFile study, std::string device);
  ~StudyPlan();
  StudyPlan(StudyPlan&&) noexcept;

  static constexpr std::size_t most_tried = 5'000;

  StudyFile const& study() const;
  /// Returns the base setup of all cases, as TOML with absolute file names.
  std::string base() const;
  /// Returns a warning if the base setup describes a sequence, since every case is then its first pair.
  Warnings warnings() const;
  std::size_t size() const;
  /// Returns a case including its line_hash. Thread-safe. @throws DataError if an input cannot be read
  ManifestCase operator[](std::size_t index) const;
  /// Returns the manifest line of a case, without line end.
  std::string line(std::size_t index) const;

 private:
  struct Parts;

  ManifestCase without_hash(std::size_t index) const;
  std::unique_ptr<Parts> parts_;
};

/// Plans a study. @throws as StudyPlan::StudyPlan
inline StudyPlan plan_study(StudyFile study, std::string device) { return {std::move(study), std::move(device)}; }

}  // namespace gladstone::inline sweep
