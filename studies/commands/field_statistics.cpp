#include "studies/commands/field_statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/available_memory.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"

namespace gladstone {
namespace {

double largest_difference(double const* a, double const* b, std::size_t count) {
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

FieldStatistics field_statistics(FieldSource& source) {
  RegularGrid const& grid = source.grid();
  auto const width = static_cast<std::size_t>(grid.nodes[0]);
  constexpr std::size_t values_at_once = std::size_t{1} << 22;
  int const rows =
      static_cast<int>(std::clamp<std::size_t>(values_at_once / width, 1, static_cast<std::size_t>(grid.nodes[1])));
  require_memory(source.name(), "a row of " + std::to_string(width) + " values",
                 4.0 * sizeof(double) * static_cast<double>(width * (static_cast<std::size_t>(rows) + 1)));
  auto const blocks = (static_cast<std::size_t>(grid.nodes[1]) + rows - 1) / static_cast<std::size_t>(rows);
  Progress progress("reading " + source.name(), blocks * static_cast<std::size_t>(grid.nodes[2]));

  FieldStatistics seen{HUGE_VAL, -HUGE_VAL, {}};
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
      Vec3d steepest{};
      for (std::size_t row = 0; row < values.size(); row += width) {
        double const* const here = values.data() + row;
        auto const [least, most] = std::minmax_element(here, here + width);
        seen.minimum = std::min(seen.minimum, *least);
        seen.maximum = std::max(seen.maximum, *most);
        steepest.x = std::max(steepest.x, largest_difference(here + 1, here, width - 1));
        if (row > 0) steepest.y = std::max(steepest.y, largest_difference(here, here - width, width));
        if (!before.empty()) steepest.z = std::max(steepest.z, largest_difference(here, before.data() + row, width));
      }
      for (int axis = 0; axis < 3; ++axis) {
        seen.steepest[axis] = std::max(seen.steepest[axis], steepest[axis] / grid.spacing[axis]);
      }
      std::swap(before, values);
      progress.advance();
    }
  }
  return seen;
}

}  // namespace gladstone
