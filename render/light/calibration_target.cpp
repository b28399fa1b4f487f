#include "render/light/calibration_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"

namespace gladstone::inline light {
namespace {

constexpr double most_dots = 1e6;  // maximum number of dots per plane; on a sensor of 100 megapixels such dots are 10
                                   // px apart
constexpr std::size_t most_planes = 999;

/// Returns the number of dots on each side of the central one along an axis.
double half_count(double extent, double spacing) {
  constexpr double rounding = 1e-9;  // tolerance in spacings, so that dots exactly on the edge are included
  return std::floor(extent / 2 / spacing + rounding);
}

}  // namespace

CalibrationTarget read_calibration_target(SetupTable table) {
  CalibrationTarget read;
  std::vector<double> planes = table.number_list("planes_mm", {-2, 0, 2}, 1, most_planes, {-1e9, 1e9});
  for (double const z : planes) read.planes.push_back(z * unit::millimetre);
  std::sort(planes.begin(), planes.end());
  if (std::adjacent_find(planes.begin(), planes.end()) != planes.end()) {
    table.problem("planes_mm", "contains a plane twice (the second one adds no information); remove one");
  }
  TargetSetup& target = read.target;
  target.kind = TargetKind::lattice;
  target.arrangement = DotArrangement::regular;
  target.spacing = table.number("spacing_mm", 2.5, Range::positive(1e6)) * unit::millimetre;
  target.dot_diameter_px.reset();
  target.dot_diameter_m = table.number("dot_diameter_mm", 0.8, Range::positive(1e6)) * unit::millimetre;
  if (*target.dot_diameter_m > 0.8 * target.spacing) {
    table.problem("dot_diameter_mm",
                  fmt::format("leaves a gap of less than a fifth of calibration.spacing_mm = {:.6g} between dots "
                              "(their images would merge); use smaller dots or a wider spacing",
                              target.spacing / unit::millimetre));
  }
  auto const extent = table.numbers("extent_mm", {40, 40}, 2, Range::positive(1e9));
  target.extent_m = Vec2d{extent[0], extent[1]} * unit::millimetre;
  target.centre_m = Vec2d{};
  double const count = (2 * half_count(target.extent_m->x, target.spacing) + 1) *
                       (2 * half_count(target.extent_m->y, target.spacing) + 1);
  if (count > most_dots) {
    table.problem("spacing_mm", fmt::format("gives {:.3g} dots on a plane ({:.0g} at most); use a wider spacing or a "
                                            "smaller extent_mm",
                                            count, most_dots));
  }
  return read;
}

Lattice::Lattice(TargetSetup const& target)
    : half_columns(static_cast<int>(half_count(target.extent_m->x, target.spacing))),
      half_rows(static_cast<int>(half_count(target.extent_m->y, target.spacing))),
      spacing(target.spacing) {}

std::vector<Vec2d> Lattice::dots() const {
  std::vector<Vec2d> places;
  places.reserve(size());
  for (std::size_t k = 0; k < size(); ++k) places.push_back({spacing * column(k), spacing * row(k)});
  return places;
}

}  // namespace gladstone::inline light
