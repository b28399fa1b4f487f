#include "render/base/fields/readers/checked_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone {
namespace {

/// The database's mark of a point without data; stored as float, so known to 3e-5.
constexpr double hole = -999.9;
constexpr double hole_tolerance = 1e-3;

constexpr std::size_t values_at_once = std::size_t{1} << 22;

bool is_hole(double value) { return std::abs(value - hole) < hole_tolerance; }

/// A number that a volume of floats can hold.
bool is_usable(double value) { return std::abs(value) <= std::numeric_limits<float>::max(); }

bool is_bad(double value) { return !is_usable(value) || is_hole(value); }

std::string share(std::size_t count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all) + " points are ";
}

}  // namespace

void CheckedSource::read_planes(int first_plane, int count, std::span<double> out) {
  std::size_t const plane = row_values() * static_cast<std::size_t>(grid_.nodes[1]);
  GLADSTONE_EXPECTS(first_plane >= 0 && count >= 0 && count <= grid_.nodes[2] - first_plane);
  GLADSTONE_EXPECTS(out.size() == plane * static_cast<std::size_t>(count));
  throw_if_interrupted();
  read_raw_planes(first_plane, count, out);
  refuse_bad_values(out);
}

void CheckedSource::read_rows(int plane, int first_row, int count, std::span<double> out) {
  GLADSTONE_EXPECTS(plane >= 0 && plane < grid_.nodes[2]);
  GLADSTONE_EXPECTS(first_row >= 0 && count >= 0 && count <= grid_.nodes[1] - first_row);
  GLADSTONE_EXPECTS(out.size() == row_values() * static_cast<std::size_t>(count));
  throw_if_interrupted();
  read_raw_rows(plane, first_row, count, out);
  refuse_bad_values(out);
}

void CheckedSource::refuse_bad_values(std::span<double const> read) {
  if (std::none_of(read.begin(), read.end(), is_bad)) return;
  std::size_t const width = row_values(), all = grid_.size() * static_cast<std::size_t>(values());
  int const rows = std::clamp(static_cast<int>(values_at_once / width), 1, grid_.nodes[1]);
  std::vector<double> values;
  std::size_t holes = 0, not_finite = 0;
  for (int z = 0; z < grid_.nodes[2]; ++z) {
    for (int row = 0; row < grid_.nodes[1]; row += rows) {
      throw_if_interrupted();
      int const count = std::min(rows, grid_.nodes[1] - row);
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
  throw DataError(path_, message + "; fetch the field again or cut the region out");
}

}  // namespace gladstone
