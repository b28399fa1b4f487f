#pragma once

#include "render/focused_dots/deflection_table.h"
#include "render/focused_dots/displacement_moments.h"
#include "render/light/sources.h"
#include "render/optics/aperture_stop.h"
#include "render/scene/truth_error.h"

/// The cone of a dot's rays: the deflection table says what each does, a few traced ones correct it. Integrals over the
/// cone are then as good as their rule, which follows waves of three of the field's finest lengths, in cones up to some
/// hundred of them wide.
namespace gladstone {

/// Points of a cone's cross-section, in units of the stop's radius, on rings that share their directions.
struct ConePoint {
  double radius;
  double weight;  ///< share of the area
  int direction;
};
struct ConeRule {
  static constexpr int most_directions = 256;
  ConePoint const* points = nullptr;
  Vec2d const* directions = nullptr;
  int count = 0;
  int direction_count = 0;
  bool fine = false;  ///< twice as fine as usual

  // where a cone has no simple edge: points of equal weights all over the disc of CorrectedCone::reach
  Vec2d const* scattered = nullptr;
  int scattered_count = 0;
  double smoothing = 0;  ///< of the stop's edge, as ApertureStop::edge

  /// Points that a cone is integrated over at each place. @param simple_edge of the stop, as seen from all of them
  GLADSTONE_HD int points_of(bool simple_edge) const { return simple_edge ? count : scattered_count; }
};

/// What the traced rays of a dot say of the table: sums over rays.
struct TableCheck {
  double rays = 0;
  Vec2d shift{}, shift_by_x{}, shift_by_y{};  ///< traced minus table [m]; times the stop's point [m^2]
  double square = 0;                          ///< |stop's point|^2 [m^2]
  Vec2d traced{}, miss{};                     ///< displacements, and by what they are more than the table's [px]
  double traced2[3] = {}, expected2[3] = {};  ///< products xx, xy, yy of the traced ones and the table's [px^2]
  Vec2d miss2{};                              ///< squares of `miss`, by component [px^2]

  /// @param at of the stop, from its middle [m]
  GLADSTONE_HD void add(Vec2d at, Deflection const& found, Deflection const& expected) {
    Vec2d const off = found.shift - expected.shift, aside = found.displacement - expected.displacement;
    rays += 1;
    shift += off;
    shift_by_x += at.x * off;
    shift_by_y += at.y * off;
    square += dot(at, at);
    traced += found.displacement;
    miss += aside;
    miss2 += squares_of(aside);
    add_products(traced2, found.displacement);
    add_products(expected2, expected.displacement);
  }
  /// Calls visit(this member, the other's) for every number.
  template <class Visit>
  GLADSTONE_HD void each_number(Visit&& visit) {
    static_assert(sizeof(TableCheck) == numbers * sizeof(double));
    auto* const first = reinterpret_cast<double*>(this);
    for (int i = 0; i < numbers; ++i) visit(first[i], i);
  }
  GLADSTONE_HD TableCheck& operator+=(TableCheck const& o) {
    auto const* const other = reinterpret_cast<double const*>(&o);
    each_number([other](double& mine, int i) { mine += other[i]; });
    return *this;
  }

 private:
  static constexpr int numbers = 20;
  GLADSTONE_HD static void add_products(double (&sum)[3], Vec2d d) {
    sum[0] += d.x * d.x;
    sum[1] += d.x * d.y;
    sum[2] += d.y * d.y;
  }
};

/// How well the displacement of a dot is known, by component [px^2].
struct CheckErrors {
  Vec2d scatter2;  ///< square of the standard error of what the rays correct the table by
  Vec2d miss2;     ///< variance from ray to ray of what the table is off by
};
/// From the scatter between independent scramblings, as displacement_error2(). @param all their sum
GLADSTONE_HD inline CheckErrors check_errors(TableCheck const* of, int scramblings, TableCheck const& all) {
  Vec2d const miss = all.miss / all.rays;
  Vec2d scatter2{};
  for (int i = 0; i < scramblings; ++i) scatter2 += squares_of((of[i].miss - of[i].rays * miss) / all.rays);
  Vec2d const miss2 = all.miss2 / all.rays - squares_of(miss);
  return {error2_factor(scramblings) * scatter2, {miss2.x > 0 ? miss2.x : 0, miss2.y > 0 ? miss2.y : 0}};
}

/// The cone of a dot's rays by the table, corrected to agree with the traced rays on average.
class CorrectedCone {
 public:
  /// Rays further from the aim than so many radii of the stop are not looked at; a table has to cover those that come
  /// to the stop in fields that widen cones no more than by a tenth, and extrapolates to others.
  static constexpr double reach = 1.25, covered = 1.1;

  /// @param distance target to lens plane [m] @param centre of the dot [m] @param aim point of the pupil about which
  /// the cone lies: what the medium makes of the ray there arrives at the stop's middle [m]
  GLADSTONE_HD CorrectedCone(DeflectionTable const& table, double stop_radius, double distance, Vec2d centre, Vec2d aim,
                             TableCheck const& check)
      : table_(table),
        stop_radius_(stop_radius),
        per_distance2_(1 / (distance * distance)),
        centre_(centre),
        aim_(aim) {
    if (!(check.rays > 0)) return;  // nothing deflects its rays
    shift_ = check.shift / check.rays;
    origin_ = check.traced / check.rays;
    miss_ = check.miss / check.rays;
    if (check.rays < fewest_rays) return;  // a handful of rays tells the mean, not how it varies
    shift_by_x_ = (2 / check.square) * check.shift_by_x;
    shift_by_y_ = (2 / check.square) * check.shift_by_y;
    Vec2d const guess = origin_ - miss_;
    widening_[0] = (check.traced2[0] - check.expected2[0]) / check.rays - origin_.x * origin_.x + guess.x * guess.x;
    widening_[1] = (check.traced2[1] - check.expected2[1]) / check.rays - origin_.x * origin_.y + guess.x * guess.y;
    widening_[2] = (check.traced2[2] - check.expected2[2]) / check.rays - origin_.y * origin_.y + guess.y * guess.y;
  }

  /// Mean displacement of the traced rays: where moments count from [px].
  GLADSTONE_HD Vec2d origin() const { return origin_; }
  GLADSTONE_HD double stop_radius() const { return stop_radius_; }
  /// The point of the pupil that lies so far from the aim.
  GLADSTONE_HD Vec2d pupil(Vec2d from_aim) const { return aim_ + from_aim; }

  /// Distance from the aim, in a direction, of the ray from a place of the source that arrives at the stop's edge [m];
  /// NaN where light crosses the edge more than once, or further out than `reach`.
  /// @param offset of the place from the dot's centre [m]
  GLADSTONE_HD double rim(Vec2d offset, Vec2d direction) const {
    using std::abs;
    // where shifts change little within their own length two looks do, as if their change went on (Aitken)
    double const first = arriving(offset, direction, stop_radius_);
    if (!(first > 0 && first <= reach * stop_radius_)) return undefined();
    double const second = arriving(offset, direction, first);
    double const change = first - stop_radius_, last = second - first;
    if (abs(change) <= settled * stop_radius_) return second;
    if (!(abs(last) <= 0.1 * abs(change)) || !(abs(last) <= 1e-3 * stop_radius_)) {
      return searched_rim(offset, direction);
    }
    double const radius = second + last * last / (change - last);
    return radius <= reach * stop_radius_ ? radius : undefined();
  }

  /// Displacement of a ray, counted from origin() [px].
  GLADSTONE_HD Vec2d displacement(Vec2d offset, Vec2d from_aim) const {
    if (!table_.exists()) return {};
    Vec2d const to = pupil(from_aim);
    return table_.displacement(table_.crossing(centre_ + offset, to), to) + miss_ - origin_;
  }
  /// Where a ray meets the stop's plane, from the stop's middle [m].
  GLADSTONE_HD Vec2d arrival(Vec2d offset, Vec2d from_aim) const {
    Vec2d const to = pupil(from_aim);
    if (!table_.exists()) return to;
    return to + table_.shift(table_.crossing(centre_ + offset, to), to) + shift_ + from_aim.x * shift_by_x_ +
           from_aim.y * shift_by_y_;
  }
  /// cos^4 of the angle at which a ray leaves the target.
  GLADSTONE_HD double lambert(Vec2d offset, Vec2d pupil_point) const {
    Vec2d const across = pupil_point - centre_ - offset;
    double const spread = 1 + dot(across, across) * per_distance2_;
    return 1 / (spread * spread);
  }
  /// Makes sums over the cone from a place shares of what the reference frame shows of it, with the width that the rays
  /// have.
  GLADSTONE_HD void finish(DisplacementMoments& moments, double without_medium) const {
    double const scale = 1 / without_medium;
    for (double& m : moments.of) m *= scale;
    for (int i = 0; i < 3; ++i) moments.of[DisplacementMoments::at(2, 0) + i] += moments.of[0] * widening_[i];
  }

 private:
  static constexpr double settled = 1e-6;    ///< of the stop's radius
  static constexpr double fewest_rays = 16;  ///< that say how the table is off across the cone
  DeflectionTable table_;
  double stop_radius_, per_distance2_;
  Vec2d centre_, aim_, shift_{}, shift_by_x_{}, shift_by_y_{}, origin_{}, miss_{};
  double widening_[3] = {};

  /// Radius at which a ray would have to be sent to arrive at the stop's edge, bent as one at `radius` is.
  GLADSTONE_HD double arriving(Vec2d offset, Vec2d direction, double radius) const {
    using std::sqrt;
    Vec2d const moved = arrival(offset, radius * direction) - radius * direction;
    double const along = dot(moved, direction);
    return sqrt(stop_radius_ * stop_radius_ - dot(moved, moved) + along * along) - along;
  }
  /// Looks along the direction as far as `reach`, and closes in on the one place where the edge is crossed.
  GLADSTONE_HD double searched_rim(Vec2d offset, Vec2d direction) const {
    constexpr int looks = 12;
    double const margin = (reach - 1) * stop_radius_, step = 2 * margin / looks;
    auto const outside = [&](double radius) { return length(arrival(offset, radius * direction)) - stop_radius_; };
    double low = 0, below = 0, high = 0, above = 0, last = 0;
    for (int look = 0; look <= looks; ++look) {
      double const radius = stop_radius_ - margin + look * step, here = outside(radius);
      if (look > 0 && !(here > last)) return undefined();
      if (here <= 0) low = radius, below = here;
      if (here > 0 && !(high > 0)) high = radius, above = here;
      last = here;
    }
    if (!(low > 0) || !(high > 0)) return undefined();
    for (int iteration = 0; iteration < 30 && high - low > settled * stop_radius_; ++iteration) {
      // regula falsi, kept off the ends so that both close in
      double const share = below / (below - above);
      double const inner = share < 0.05 ? 0.05 : (share > 0.95 ? 0.95 : share);
      double const radius = low + inner * (high - low), here = outside(radius);
      if (here <= 0) {
        low = radius, below = here;
      } else {
        high = radius, above = here;
      }
    }
    // the secant's root, which does not jump where rounding changes the number of iterations
    return low + below / (below - above) * (high - low);
  }
  GLADSTONE_HD static double undefined() { return std::numeric_limits<double>::quiet_NaN(); }
};

/// What one point of the rule stands for.
struct ConeLight {
  Vec2d displacement;     ///< counted from the cone's origin [px]
  double weight;          ///< of the light that arrives in the flow
  double without_medium;  ///< and in the reference frame
};

/// @param rims of the rule's directions, from a place of the source: the points fill what they enclose; null where the
/// stop's edge has no single rim as seen from the source, near a caustic: they fill all that is looked at, and the
/// stop's edge is smoothed as it is for rays
GLADSTONE_HD inline ConeLight cone_light(CorrectedCone const& cone, ConeRule const& rule, int point, Vec2d offset,
                                         double const* rims) {
  if (!rims) {
    constexpr double wide = CorrectedCone::reach;
    ApertureStop<double> const stop{0, cone.stop_radius(), rule.smoothing};
    Vec2d const from_aim = (wide * cone.stop_radius()) * rule.scattered[point],
                arrival = cone.arrival(offset, from_aim);
    double const weight = wide * wide / rule.scattered_count;
    return {cone.displacement(offset, from_aim),
            weight * cone.lambert(offset, cone.pupil(from_aim)) * stop.transmission(arrival.x, arrival.y),
            weight * cone.lambert(offset, from_aim) * stop.transmission(from_aim.x, from_aim.y)};
  }
  ConePoint const at = rule.points[point];
  Vec2d const direction = rule.directions[at.direction];
  double const rim = rims[at.direction], widened = rim / cone.stop_radius();
  Vec2d const from_aim = (at.radius * rim) * direction;
  return {cone.displacement(offset, from_aim),
          at.weight * widened * widened * cone.lambert(offset, cone.pupil(from_aim)),
          at.weight * cone.lambert(offset, (at.radius * cone.stop_radius()) * direction)};
}

}  // namespace gladstone
