#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/setup/setup_node.h"
#include "studies/sweep/manifest.h"

namespace gladstone {

enum class StudyMode { grid, zip, sobol };

/// Value of an axis: its label in tables, and the corresponding node of the setup.
struct AxisValue {
  ParameterValue parameter;
  SetupNode node;
};

/// Axis of a study file: a list of values, or a range of numbers that are generated on access.
struct AxisPlan {
  struct Range {
    double first = 0, last = 0;
    std::size_t count = 0;
    bool logarithmic = false;
    bool whole = false;  ///< both ends are integers; integral values of the range are then written as integers
  };

  std::string key;                ///< key path, such as "lens.f_number"
  std::vector<std::string> path;  ///< parts of the key path
  SetupPlace place;
  std::vector<AxisValue> list;
  std::optional<Range> range;  ///< replaces `list`

  std::size_t size() const { return range ? range->count : list.size(); }
  /// @pre i < size()
  AxisValue value(std::size_t i) const;
  /// Returns the value at u in [0, 1): a number of the range, or the element of the list at fraction u.
  AxisValue value_at(double u) const;
};

/// Study file, checked by itself; the setups of its cases are checked by plan_study().
struct StudyFile {
  std::string path;
  std::string text;
  std::string base_path, base_text;
  std::vector<AxisPlan> axes;  ///< in the order of the file
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

}  // namespace gladstone
