#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/setup/setup_node.h"
#include "studies/sweep/manifest.h"

namespace gladstone::inline sweep {

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
  std::optional<Range> range;  ///< range of generated numbers, used instead of `list`

  std::size_t size() const { return range ? range->count : list.size(); }
  /// @pre i < size()
  AxisValue value(std::size_t i) const;
  /// Returns the value at u in [0, 1): a number of the range, or the element of the list at fraction u.
  AxisValue value_at(double u) const;
};

/// Returns true if adjacent values of the range certainly differ after rounding to twelve digits, a relative error of
/// at most 1e-11.
bool surely_tells_values_apart(AxisPlan::Range const& range);

}  // namespace gladstone::inline sweep
