#pragma once

#include "render/focused_dots/cone_integral.h"

/// Light of a dot whose displacements are sorted into squares (MomentImages), computed by a group of lanes: OneLane on
/// the CPU, a block of threads on a GPU.
namespace gladstone::inline focused_dots {

/// Work space shared by a group's lanes.
/// @tparam abreast  number of squares whose light is computed together
template <int abreast>
struct SquareSums {
  SquareRange range;
  int listed;                                                        ///< number of squares that contain light
  unsigned short list[SquareRange::most];                            ///< indices of these squares
  unsigned short ends[PlaceRule::max_positions][SquareRange::most];  ///< index behind the last point of each square, in
                                                                     ///< the order of `ConePoints::order`
  DisplacementMoments moments[abreast][PlaceRule::max_positions];
  double shares[DisplacementMoments::count * PlaceRule::terms][abreast];  ///< weights of the MomentImages of each
                                                                          ///< square

  GLADSTONE_HD int begin(int place, int square) const { return square > 0 ? ends[place][square - 1] : 0; }
};

/// Nodes of a wide dot's light cone.
struct ConePoints {
  ConeLight* light;       ///< contributions of the nodes, [place][count]
  unsigned short* order;  ///< indices of the nodes, sorted by square, [place][count]
  int count;
};

/// Sorts the nodes of a light cone by the square that contains their displacement, for one point of the source. The
/// order of the nodes within a square is retained. Called by all lanes of a team.
/// @param ends  output: end of each square's nodes in the sorted order
template <class Team>
GLADSTONE_HD void sort_points(Team const& team, DotSquares const& squares, SquareRange const& range,
                              ConeLight const* light, int count, unsigned short* order, unsigned short* ends) {
  auto const visit_points = [&](auto const& visit) {
    for (int base = 0; base < count; base += team.size()) {
      int const k = base + team.lane();
      int square = -1;
      if (k < count && light[k].weight != 0) square = range.index(squares.square_of(light[k].displacement));
      visit(k, square, team.same(square));
      team.sync();
    }
  };
  for (int square = team.lane(); square < range.count(); square += team.size()) ends[square] = 0;
  team.sync();
  visit_points([&](int, int square, auto same) {
    if (square >= 0 && same.before == 0) ends[square] = static_cast<unsigned short>(ends[square] + same.all);
  });
  int below = 0;
  for (int base = 0; base < range.count(); base += team.size()) {
    int const square = base + team.lane();
    int all = 0;
    int const begin = below + team.sum_below(square < range.count() ? ends[square] : 0, all);
    if (square < range.count()) ends[square] = static_cast<unsigned short>(begin);
    below += all;
  }
  team.sync();
  visit_points([&](int k, int square, auto same) {
    int const first = square >= 0 ? ends[square] : 0;
    team.sync();
    if (square < 0) return;
    order[first + same.before] = static_cast<unsigned short>(k);
    if (same.before == 0) ends[square] = static_cast<unsigned short>(first + same.all);
  });
}

/// Lists the squares that contain light, in any order.
/// @param phase  only squares of this phase; -1: all
template <class Group, class Sums>
GLADSTONE_HD void list_squares(Group const& group, DotModel const& model, DotSquares const& squares, int phase,
                               Sums& sums) {
  if (group.lane() == 0) sums.listed = 0;
  group.sync();
  for (int square = group.lane(); square < sums.range.count(); square += group.size()) {
    if (phase >= 0 && squares.phase(sums.range.square(square)) != phase) continue;
    bool lit = false;
    for (int place = 0; place < model.places.count; ++place) {
      lit = lit || sums.ends[place][square] > sums.begin(place, square);
    }
    if (lit) sums.list[group.take(sums.listed)] = static_cast<unsigned short>(square);
  }
  group.sync();
}

/// Computes the moments of the displacements in some squares at each point of the source, with eight lanes per square
/// and point.
/// @param list  squares
/// @param here  number of squares
template <class Group, class Sums>
GLADSTONE_HD void sum_squares(Group const& group, DotModel const& model, CorrectedCone const& cone,
                              double const* without_medium, DotSquares const& squares, ConePoints const& points,
                              unsigned short const* list, int here, Sums& sums) {
  auto const eight = group.eight();
  int const places = model.places.count, tasks = here * places;
  for (int first = 0; first < tasks; first += eight.count()) {
    int const task = first + eight.index(), last = task < tasks ? task : tasks - 1;
    int const which = last / places, place = last % places, square = list[which];
    int const end = task < tasks ? sums.ends[place][square] : 0;
    Vec2<int> const of_dot = sums.range.square(square);
    DisplacementMoments moments;
    for (int i = sums.begin(place, square) + eight.lane(); i < end; i += eight.size()) {
      ConeLight const& light = points.light[place * points.count + points.order[place * points.count + i]];
      moments.add(light.weight, squares.from_middle(light.displacement, of_dot));
    }
    for (double& moment : moments.of) moment = eight.sum(moment);
    if (task >= tasks) continue;
    cone.finish(moments, without_medium[place]);
    for (int i = 0; i < DisplacementMoments::count; ++i) {
      if (i % eight.size() == eight.lane()) sums.moments[which][place].of[i] = moments.of[i];
    }
  }
  group.sync();
}

/// Adds the light of some squares of the same phase to the patch.
/// @tparam pixels  number of pixels that a lane processes together
/// @pre sums.shares contains the weights for these squares
template <int pixels, class Group, int abreast, class Patch>
GLADSTONE_HD void add_squares(Group const& group, MomentImages const& images, DotSquares const& squares,
                              unsigned short const* list, int here, SquareSums<abreast> const& sums, Patch& patch) {
  int const all = images.width() * images.width();
  double const* const of_phase = images.of_phase(squares.phase(sums.range.square(list[0])));
  for (int base = 0; base < all; base += pixels * group.size()) {
    int const first = base + pixels * group.lane();
    double light[abreast][pixels] = {};
    if (first < all) {
      double const* of_image = of_phase + first;
      for (int image = 0; image < images.count(); image += DisplacementMoments::count) {
        for (int k = 0; k < DisplacementMoments::count; ++k, of_image += images.stride) {
          for (int which = 0; which < abreast; ++which) {
            for (int i = 0; i < pixels; ++i) light[which][i] += sums.shares[image + k][which] * of_image[i];
          }
        }
      }
    }
    for (int which = 0; which < abreast; ++which) {
      if (first < all && which < here) {
        patch.add_run(images.footprint(squares.on_sensor(sums.range.square(list[which]))), first, light[which]);
      }
      group.sync_team();  // wait: the next square may cover the same pixels
    }
  }
}

/// Renders the light of a wide dot.
/// @tparam pixels  number of pixels that a lane processes together
template <int pixels, class Group, int abreast, class Patch>
GLADSTONE_HD void accumulate_light_by_squares(Group const& group, DotModel const& model, DotCone const& dot,
                                              CorrectedCone const& cone, ConeIntegral const& whole,
                                              ConePoints const& points, SquareSums<abreast>& sums, Patch& patch) {
  MomentImages const& images = model.moment_images;
  SpannedSquares const spanned(images.lattice, model.to_pixel(dot.centre) + dot.origin, dot.extent);
  DotSquares const& squares = spanned.squares;
  if (group.lane() == 0) sums.range = spanned.range;
  group.sync();
  auto const team = group.team();
  for (int place = team.index(); place < model.places.count; place += team.count()) {
    sort_points(team, squares, sums.range, points.light + place * points.count, points.count,
                points.order + place * points.count, sums.ends[place]);
  }
  group.sync();
  double const units = dot.light * patch.units_per_weight();
  // Squares are processed by phase, or regardless of phase if only one is processed at a time.
  for (int phase = abreast > 1 ? 0 : -1; phase < (abreast > 1 ? images.phases() : 0); ++phase) {
    list_squares(group, model, squares, phase, sums);
    for (int first = 0; first < sums.listed; first += abreast) {
      unsigned short const* const list = sums.list + first;
      int const here = sums.listed - first < abreast ? sums.listed - first : abreast;
      sum_squares(group, model, cone, whole.without_medium, squares, points, list, here, sums);
      for (int k = group.lane(); k < images.count() * abreast; k += group.size()) {
        int const image = k / abreast, which = k % abreast;
        sums.shares[image][which] = which < here
                                        ? units * MomentField::fitted(model.places, sums.moments[which],
                                                                      image / images.terms, image % images.terms)
                                        : 0.0;
      }
      group.sync();
      add_squares<pixels>(group, images, squares, list, here, sums, patch);
    }
    group.sync();
  }
}

}  // namespace gladstone::inline focused_dots
