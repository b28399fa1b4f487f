#pragma once

#include "render/focused_dots/dot_model.h"
#include "render/focused_dots/spot_factors.h"

/// Image of a disc-shaped source, computed point by point by a group of lanes: OneLane on the CPU, a block of threads
/// on a GPU.
namespace gladstone::inline focused_dots {

/// Returns the size of a team's work space for one point [numbers].
GLADSTONE_HD constexpr int point_numbers(int orders, int pitch) {
  return 2 * orders * pitch + DisplacementMoments::count;
}

/// Renders a source's disc: each of its points contributes the PSF convolved with the distribution of displacements, by
/// their moments. A team processes some points at a time: first the factors of their PSFs along both axes, then for
/// each order along x the sum over orders along y, then their pixels.
/// @tparam orders  order of the displacement moments plus one; 1: no displacement
/// @tparam pixels  number of pixels that a lane processes together: 1, or at least the width of the PSF, so that all
/// loops use whole vector registers
/// @param origin  image of the source's centre, to which the moments are relative [px]
/// @param field  moments as a function of the position on the source, or null
/// @param room  work space of a team
/// @param points  number of points for which there is work space
template <int orders, int pixels, class Group, class Patch>
GLADSTONE_HD void accumulate_light_by_points(Group const& group, DotModel const& model, Vec2d origin, double light,
                                             MomentField const* field, Patch& patch, double* room, int points) {
  using M = DisplacementMoments;
  using std::abs;
  GaussianSpot<double> const spot = model.spot;
  int const width = 2 * spot.half_width() + 1, pitch = pixels > 1 ? pixels : width + 1;
  auto const team = group.team();
  auto const eight = team.eight();
  if (!(abs(origin.x) < 1e8 && abs(origin.y) < 1e8)) return;  // the position is outside any image
  CubatureView const& source = model.source;
  double const units = light * patch.units_per_weight();
  auto const at_point = [&](int i) { return origin + model.half_size_px() * source.points[i]; };
  // Layout of a point's work space: PSF factors [axis][order][pixel], then the moments.
  int const apart = point_numbers(orders, pitch);
  for (int first = team.index() * points; first < source.count; first += team.count() * points) {
    int const here = source.count - first < points ? source.count - first : points;
    spot_factors<orders>(
        team, spot, [&](int which) { return at_point(first + which); }, here, pitch, apart, room);
    for (int i = team.lane(); i < here * M::count && orders > 1; i += team.size()) {
      int const which = i / M::count, point = first + which, moment = i % M::count;
      room[which * apart + 2 * orders * pitch + moment] =
          units * source.weights[point] * field->value(moment, source.points[point]);
    }
    team.sync();
    for (int which = eight.index(); which < here; which += eight.count()) {
      double* const along_x = room + which * apart;
      double const* const moments = along_x + 2 * orders * pitch;
      for (int row = pixels * eight.lane(); row < (pixels > 1 ? pixels : width); row += pixels * eight.size()) {
        double* const along_y = along_x + orders * pitch + row;
        double with[orders][pixels] = {};
        for (int a = 0; a < orders; ++a) {
          for (int b = 0; a + b < orders; ++b) {
            double const moment = orders > 1 ? moments[M::at(a, b)] : units * source.weights[first + which];
            for (int i = 0; i < pixels; ++i) with[a][i] += moment * along_y[b * pitch + i];
          }
        }
        for (int a = 0; a < orders; ++a) {
          for (int i = 0; i < pixels; ++i) along_y[a * pitch + i] = with[a][i];
        }
      }
    }
    team.sync();
    for (int which = 0; which < here; ++which) {
      double const *const along_x = room + which * apart, *const along_y = along_x + orders * pitch;
      patch.template add<pixels>(team, spot.footprint(at_point(first + which)),
                                 [=](int row, int column, double(&line)[pixels]) {
                                   for (int a = 0; a < orders; ++a) {
                                     double const share = along_y[a * pitch + row];
                                     for (int i = 0; i < pixels; ++i)
                                       line[i] += share * along_x[a * pitch + column + i];
                                   }
                                 });
      team.sync();
    }
  }
}

}  // namespace gladstone::inline focused_dots
