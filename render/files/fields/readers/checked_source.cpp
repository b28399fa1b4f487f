#include "render/files/fields/readers/checked_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone::inline files {
namespace {

/// Value that marks missing data in the Johns Hopkins Turbulence Databases; as a float it is exact to 3e-5.
constexpr double hole = -999.9;
constexpr double hole_tolerance = 1e-3;

constexpr std::size_t values_at_once = std::size_t{1} << 22;

bool is_hole(double value) { return std::abs(value - hole) < hole_tolerance; }

/// Returns true for numbers within the range of float; false for NaN.
bool is_usable(double value) { return std::abs(value) <= std::numeric_limits<float>::max(); }

bool is_bad(double value) { return !is_usable(value) || is_hole(value); }

std::string share(std::size_t count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all) + " points are ";
}

}  // namespace

void CheckedSource::describe(std::array<int, 3> const& nodes, std::size_t rank, std::string by) {
  nodes_ = nodes;
  reading_.axes.clear();
  reading_.shape.clear();
  for (std::size_t axis = rank; axis-- > 0;) {
    reading_.axes += axes_[axis].world;
    reading_.shape.push_back(static_cast<std::size_t>(nodes[axis]));
    if (nodes[axis] > 1 && axes_[axis].step < 0) reading_.turned_round += axes_[axis].world;
    if (nodes[axis] > 1 && !axes_[axis].stated) units_.unspaced += axes_[axis].world;
  }
  std::sort(units_.unspaced.begin(), units_.unspaced.end());
  std::sort(reading_.turned_round.begin(), reading_.turned_round.end());
  reading_.by = std::move(by);
}

void CheckedSource::read_rows(int plane, int first_row, int count, std::span<double> out) {
  GLADSTONE_EXPECTS(plane >= 0 && plane < nodes_[2]);
  GLADSTONE_EXPECTS(first_row >= 0 && count >= 0 && count <= nodes_[1] - first_row);
  GLADSTONE_EXPECTS(out.size() == row_values() * static_cast<std::size_t>(count));
  throw_if_interrupted();
  read_raw_rows(plane, first_row, count, out);
  refuse_bad_values(out);
}

void CheckedSource::refuse_bad_values(std::span<double const> read) {
  if (std::none_of(read.begin(), read.end(), is_bad)) return;
  std::size_t const width = row_values();
  std::size_t const all = row_values() * static_cast<std::size_t>(nodes_[1]) * static_cast<std::size_t>(nodes_[2]);
  int const rows = std::clamp(static_cast<int>(values_at_once / width), 1, nodes_[1]);
  std::vector<double> values;
  std::size_t holes = 0, not_finite = 0;
  for (int z = 0; z < nodes_[2]; ++z) {
    for (int row = 0; row < nodes_[1]; row += rows) {
      throw_if_interrupted();
      int const count = std::min(rows, nodes_[1] - row);
      values.resize(width * static_cast<std::size_t>(count));
      read_raw_rows(z, row, count, values);
      holes += static_cast<std::size_t>(std::count_if(values.begin(), values.end(), is_hole));
      not_finite += static_cast<std::size_t>(
          std::count_if(values.begin(), values.end(), [](double value) { return !is_usable(value); }));
    }
  }
  std::string message = "dataset \"" + name_ + "\": ";
  if (holes > 0) message += share(holes, all) + "holes (-999.9, the database's mark for missing data)";
  if (not_finite > 0) message += (holes > 0 ? ", " : "") + share(not_finite, all) + "nan or infinite";
  throw DataError(ErrorCode::invalid_value, path_, message + "; fetch the field again or cut the region out");
}

}  // namespace gladstone::inline files
