#include "studies/commands/field_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "render/base/available_memory.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"

namespace gladstone::inline commands {
namespace {

/// Raises the largest absolute difference of each component by those between two rows of nodes, `a` and `b`.
/// @param count  number of values in a row, not of nodes
void raise_differences(double const* a, double const* b, std::size_t count, std::vector<double>& largest) {
  std::size_t const components = largest.size();
  for (std::size_t i = 0; i < count; ++i) {
    double& seen = largest[i % components];
    seen = std::max(seen, std::abs(a[i] - b[i]));
  }
}

/// Raises the extremes of each component by those of a row of nodes.
void add_row(std::span<double const> row, std::vector<FieldStatistics>& seen) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    FieldStatistics& one = seen[i % seen.size()];
    one.minimum = std::min(one.minimum, row[i]);
    one.maximum = std::max(one.maximum, row[i]);
  }
}

}  // namespace

std::vector<FieldStatistics> field_statistics(FieldSource& source) {
  RegularGrid const& grid = source.grid();
  auto const components = static_cast<std::size_t>(source.values());
  auto const width = components * static_cast<std::size_t>(grid.nodes[0]);
  constexpr std::size_t values_at_once = std::size_t{1} << 22;
  int const rows =
      static_cast<int>(std::clamp<std::size_t>(values_at_once / width, 1, static_cast<std::size_t>(grid.nodes[1])));
  require_memory(source.name(), "a row of " + std::to_string(width) + " values",
                 4.0 * sizeof(double) * static_cast<double>(width * (static_cast<std::size_t>(rows) + 1)));
  auto const blocks = (static_cast<std::size_t>(grid.nodes[1]) + rows - 1) / static_cast<std::size_t>(rows);
  Progress progress("reading " + source.name(), blocks * static_cast<std::size_t>(grid.nodes[2]));

  std::vector<FieldStatistics> seen(components, {HUGE_VAL, -HUGE_VAL, {}});
  std::array<std::vector<double>, 3> steepest;  // differences along x, y and z
  steepest.fill(std::vector<double>(components));
  std::vector<double> values, before;
  for (int first = 0; first < grid.nodes[1]; first += rows) {
    int const last = std::min(first + rows, grid.nodes[1]);
    // the last row of the previous block is adjacent to the first row of this one
    int const from = std::max(first - 1, 0);
    before.clear();
    for (int k = 0; k < grid.nodes[2]; ++k) {
      throw_if_interrupted();
      values.resize(width * static_cast<std::size_t>(last - from));
      source.read_rows(k, from, last - from, values);
      for (std::size_t row = 0; row < values.size(); row += width) {
        double const* const here = values.data() + row;
        add_row({here, width}, seen);
        raise_differences(here + components, here, width - components, steepest[0]);
        if (row > 0) raise_differences(here, here - width, width, steepest[1]);
        if (!before.empty()) raise_differences(here, before.data() + row, width, steepest[2]);
      }
      std::swap(before, values);
      progress.advance();
    }
  }
  for (std::size_t i = 0; i < components; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      seen[i].steepest[axis] = steepest[static_cast<std::size_t>(axis)][i] / grid.spacing[axis];
  }
  return seen;
}

}  // namespace gladstone::inline commands
