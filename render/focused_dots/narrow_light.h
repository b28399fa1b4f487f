#pragma once

#include "render/focused_dots/dot_model.h"

/// Light of a source's disc, point by point, by a group of lanes (OneLane, or a device's).
namespace gladstone {

/// Numbers that a team needs for the spot of one point.
/// @param orders of displacement @param pitch from one row of pixels to the next
GLADSTONE_HD constexpr int spot_numbers(int orders, int pitch) {
  return 2 * orders * pitch + DisplacementMoments::count;
}

/// Factors of a spot along an axis, as GaussianSpot::taylor_shares: on one lane those of its pixels, with zeros beyond;
/// on several their edges', of which pixels are the differences.
/// @param p of the spot [px] @param first pixel @param out [order][pitch]
template <int orders, class Group>
GLADSTONE_HD void factors_along(Group const& group, GaussianSpot<double> const& spot, double p, int first, int width,
                                int pitch, double* out) {
  using Spot = GaussianSpot<double>;
  if constexpr (Group::alone) {
    double shares[orders * Spot::most_width];
    spot.taylor_shares(p, first, width, orders - 1, shares);
    for (int k = 0; k < orders; ++k) {
      for (int i = 0; i < pitch; ++i) out[k * pitch + i] = i < width ? shares[k * width + i] : 0.0;
    }
  } else {
    double const per_sigma = 1 / spot.sigma;
    for (int edge = group.lane(); edge <= width; edge += group.size()) {
      double const t = (first - p + edge - 0.5) * per_sigma;
      Spot::EdgeTerms const terms(t, per_sigma);
      out[edge] = Spot::edge_value(t);
      for (int k = 1; k < orders; ++k) out[k * pitch + edge] = terms.of[k];
    }
  }
}

/// Lays down a source's disc with the spots that moments of displacement make of its points. A team takes some points
/// at a time: first the spots' factors along both axes, then what of the rows stands with an order along x, then their
/// pixels.
/// @tparam orders of displacement, plus one: 1 where nothing is displaced
/// @tparam pixels that a lane works out side by side: 1, or a spot's whole width and more, so that every loop keeps to
/// vector registers
/// @param origin image of the source's centre where the moments count from [px] @param field of the moments, or null
/// @param room for a team's numbers @param points of the source that it has room for
template <int orders, int pixels, class Group, class Patch>
GLADSTONE_HD void lay_down_points(Group const& group, DotModel const& model, Vec2d origin, double light,
                                  MomentField const* field, Patch& patch, double* room, int points) {
  using M = DisplacementMoments;
  using Spot = GaussianSpot<double>;
  Spot const spot = model.spot;
  int const width = 2 * spot.half_width() + 1, pitch = pixels > 1 ? pixels : width + 1;
  auto const team = group.team();
  auto const eight = team.eight();
  auto const at_point = [&](int i) {
    Deposit const here = reference_light(model, origin, light, i);
    bool const sound = here.at.x < 1e8 && here.at.x > -1e8 && here.at.y < 1e8 && here.at.y > -1e8;
    return sound ? here : Deposit{};
  };
  // numbers of a point: [axis][order][pixel], then its moments
  auto const numbers = [&](int which) { return room + which * spot_numbers(orders, pitch); };
  for (int first = team.index() * points; first < model.source.count; first += team.count() * points) {
    int const here = model.source.count - first < points ? model.source.count - first : points;
    for (int axis = eight.index(); axis < 2 * here; axis += eight.count()) {
      Deposit const point = at_point(first + axis / 2);
      Footprint const reach = spot.footprint(point.at);
      bool const along_x = axis % 2 == 0;
      factors_along<orders>(eight, spot, along_x ? point.at.x : point.at.y, along_x ? reach.column : reach.row, width,
                            pitch, numbers(axis / 2) + axis % 2 * orders * pitch);
    }
    for (int i = team.lane(); i < here * M::count && orders > 1; i += team.size()) {
      int const which = i / M::count, moment = i % M::count;
      numbers(which)[2 * orders * pitch + moment] = at_point(first + which).weight * patch.units_per_weight() *
                                                    field->value(moment, model.source.points[first + which]);
    }
    team.sync();
    if constexpr (!team.alone) {  // from edges to pixels
      for (int task = team.lane(); task < here * 2 * orders; task += team.size()) {
        double* const factors = numbers(task / (2 * orders)) + task % (2 * orders) * pitch;
        for (int i = 0; i < width; ++i) factors[i] = factors[i + 1] - factors[i];
      }
      team.sync();
    }
    for (int which = eight.index(); which < here; which += eight.count()) {
      double const* const moments = numbers(which) + 2 * orders * pitch;
      double const weight = orders > 1 ? 0 : at_point(first + which).weight * patch.units_per_weight();
      for (int row = pixels * eight.lane(); row < (pixels > 1 ? pixels : width); row += pixels * eight.size()) {
        double* const along_y = numbers(which) + orders * pitch + row;
        double with[orders][pixels] = {};
        for (int a = 0; a < orders; ++a) {
          for (int b = 0; a + b < orders; ++b) {
            double const moment = orders > 1 ? moments[M::at(a, b)] : weight;
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
      double const *const along_x = numbers(which), *const along_y = along_x + orders * pitch;
      patch.template add<pixels>(team, spot.footprint(at_point(first + which).at),
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

}  // namespace gladstone
