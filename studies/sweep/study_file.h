#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/setup/setup_table.h"
#include "studies/sweep/study_axis.h"

namespace gladstone::inline sweep {

enum class StudyMode { grid, zip, sobol };

/// Study file, checked by itself; the setups of its cases are checked by plan_study().
struct StudyFile {
  std::string path;
  std::string text;
  std::string base_path;
  std::shared_ptr<SetupDocument const> base;  ///< setup from which every case starts
  std::vector<AxisPlan> axes;                 ///< axes in the order of the file
  StudyMode mode = StudyMode::grid;
  std::size_t samples = 0;  ///< number of samples in sobol mode
  std::size_t repeats = 1;
  std::uint64_t seed = 1;
  SetupPlace place;  ///< position of [axes] in the file

  std::size_t points() const;
};

/// Maximum number of cases of a study.
inline constexpr std::size_t most_cases = 1'000'000;

/// Reads a study file. Cases are not enumerated; a study with too many is rejected by its computed number of cases.
/// @throws SetupError with all problems together, at file:line:column
StudyFile read_study(std::string const& path);

}  // namespace gladstone::inline sweep
