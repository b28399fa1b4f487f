#pragma once

#include <memory>
#include <string>

#include "studies/sweep/manifest.h"
#include "studies/sweep/study_file.h"

namespace gladstone {

/// Every case of a study, each made when it is asked for: repeats outermost, of a grid the last axis fastest, so that
/// neighbours share most. Seeds of target, pupil and noise derive from the study's seed and the repeat alone; an axis
/// that names a seed wins.
class StudyPlan {
 public:
  /// Tries every value of every axis (of a range that sobol samples: its ends and a sample) by loading its setup whole,
  /// with the other axes at their first value (zip: every pair); of more than most_tried, as many spread evenly. What
  /// goes wrong in other combinations only is left to the run.
  /// @param device "cpu" or "cuda"
  /// @throws SetupError at the study's and the base's own lines
  StudyPlan(StudyFile study, std::string device);
  ~StudyPlan();
  StudyPlan(StudyPlan&&) noexcept;

  static constexpr std::size_t most_tried = 5'000;

  StudyFile const& study() const;
  /// The setup that every case starts from, as TOML with absolute file names.
  std::string base() const;
  std::size_t size() const;
  /// A case, its line_hash included. From any thread. @throws DataError for inputs that cannot be read
  ManifestCase operator[](std::size_t index) const;
  /// Its line in the manifest, without line end.
  std::string line(std::size_t index) const;

 private:
  struct Parts;

  ManifestCase without_hash(std::size_t index) const;
  std::unique_ptr<Parts> parts_;
};

/// Plans a study. @throws as StudyPlan
inline StudyPlan plan_study(StudyFile study, std::string device) { return {std::move(study), std::move(device)}; }

}  // namespace gladstone
