#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/setup_node.h"
#include "studies/sweep/manifest.h"

namespace gladstone {

enum class StudyMode { grid, zip, sobol };

/// A value of an axis: how tables name it, and what the setup's key becomes.
struct AxisValue {
  ParameterValue parameter;
  SetupNode node;
};

/// An axis as the study file writes it: a list of values, or a range of numbers, of which none is made before it is
/// asked for.
struct AxisPlan {
  struct Range {
    double first = 0, last = 0;
    std::size_t count = 0;
    bool logarithmic = false;
    bool whole = false;  ///< both ends are written as whole numbers: so are values that are whole
  };

  std::string key;                ///< "lens.f_number"
  std::vector<std::string> path;  ///< its steps
  SetupPlace place;
  std::vector<AxisValue> list;
  std::optional<Range> range;  ///< instead of the list

  std::size_t size() const { return range ? range->count : list.size(); }
  /// @pre i < size()
  AxisValue value(std::size_t i) const;
  /// The value at u in [0, 1): along the range, or the list's element that u falls on.
  AxisValue value_at(double u) const;
};

/// A study file, read and checked by itself; its setups are checked by plan_study.
struct StudyFile {
  std::string path;
  std::string text;
  std::string base_path, base_text;
  std::vector<AxisPlan> axes;  ///< as they stand in the file
  StudyMode mode = StudyMode::grid;
  std::size_t samples = 0;  ///< of sobol
  std::size_t repeats = 1;
  std::uint64_t seed = 1;
  SetupPlace place;  ///< of [axes]

  std::size_t points() const;
};

/// Most cases of a study.
inline constexpr std::size_t most_cases = 1'000'000;

/// Reads a study file. Nothing is enumerated: a study of too many cases is refused by their count.
/// @throws SetupError with all problems together, at file:line:column
StudyFile read_study(std::string const& path);

}  // namespace gladstone
