#include "render/medium/density_readers/checked_source.h"

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

bool is_hole(double value) { return std::abs(value - hole) < hole_tolerance; }

/// A number that a volume of floats can hold.
bool is_usable(double value) { return std::abs(value) <= std::numeric_limits<float>::max(); }

bool is_bad(double value) { return !is_usable(value) || is_hole(value); }

std::string share(std::size_t count, std::size_t all) {
  return std::to_string(count) + " of " + std::to_string(all) + " points are ";
}

}  // namespace

void CheckedSource::read_planes(int first_plane, int count, std::span<double> out) {
  std::size_t const plane = static_cast<std::size_t>(grid_.nodes[0]) * static_cast<std::size_t>(grid_.nodes[1]);
  GLADSTONE_EXPECTS(first_plane >= 0 && count >= 0 && count <= grid_.nodes[2] - first_plane);
  GLADSTONE_EXPECTS(out.size() == plane * static_cast<std::size_t>(count));
  read_raw_planes(first_plane, count, out);
  if (std::none_of(out.begin(), out.end(), is_bad)) return;

  std::vector<double> values(plane);
  std::size_t holes = 0, not_finite = 0;
  for (int z = 0; z < grid_.nodes[2]; ++z) {
    throw_if_interrupted();
    read_raw_planes(z, 1, values);
    holes += static_cast<std::size_t>(std::count_if(values.begin(), values.end(), is_hole));
    not_finite += static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double value) { return !is_usable(value); }));
  }
  std::string message = "dataset \"" + name_ + "\": ";
  if (holes > 0) message += share(holes, grid_.size()) + "holes (-999.9, the database's mark for missing data)";
  if (not_finite > 0) message += (holes > 0 ? ", " : "") + share(not_finite, grid_.size()) + "nan or infinite";
  throw DataError(path_, message + "; fetch the field again or cut the region out");
}

}  // namespace gladstone
