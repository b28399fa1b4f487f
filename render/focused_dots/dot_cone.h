#pragma once

#include "render/focused_dots/deflection_table.h"
#include "render/focused_dots/displacement_moments.h"
#include "render/light/sources.h"
#include "render/optics/aperture_stop.h"
#include "render/scene/truth_error.h"

/// Light cone of a dot: the deflection table provides the deflection of each ray, and a few traced rays correct it. The
/// integrals over the cone are then as accurate as their cubature rule, which resolves waves of three times the field's
/// finest length, in cones up to a few hundred of these lengths wide.
namespace gladstone::inline focused_dots {

/// Node of a cone's cross-section, on rings that share their directions.
struct ConePoint {
  double radius;  ///< radius in units of the stop's radius
  double weight;  ///< fraction of the cross-section's area
  int direction;  ///< index of the direction
};
/// Cubature rule over a light cone's cross-section.
struct ConeRule {
  static constexpr int most_directions = 256;
  ConePoint const* points = nullptr;
  Vec2d const* directions = nullptr;
  int count = 0;
  int direction_count = 0;
  bool fine = false;  ///< true: at least twice as many rings and directions as usual

  // Rule for a cone without a simple edge: points of equal weight over the whole disc of radius CorrectedCone::reach.
  Vec2d const* scattered = nullptr;
  int scattered_count = 0;
  double smoothing = 0;  ///< width of the smoothed edge of the stop, as ApertureStop::edge

  /// Number of nodes over which a cone is integrated at each point of the source.
  /// @param simple_edge  whether the edge of the stop is single-valued as seen from all of these points
  GLADSTONE_HD int points_of(bool simple_edge) const { return simple_edge ? count : scattered_count; }
};

/// Comparison of a dot's traced rays with the deflection table: sums over rays.
struct TableCheck {
  double rays = 0;
  Vec2d shift{}, shift_by_x{}, shift_by_y{};  ///< sums of the traced minus the tabulated shift [m], and of the products
                                              ///< of this difference with the coordinates of the stop point [m^2]
  double square = 0;       ///< sum of the squared distances of the stop points from the cone's centre [m^2]
  Vec2d traced{}, miss{};  ///< sums of the traced displacement, and of the traced minus the tabulated one [px]
  /// sums of the products xx, xy, yy of traced and of tabulated displacements [px^2]
  double traced2[3] = {}, expected2[3] = {};
  Vec2d miss2{};  ///< sums of the squared components of traced minus tabulated displacement [px^2]

  /// Adds a ray.
  /// @param at  point of the stop, relative to the centre of the cone [m]
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
  /// Calls visit(number, index) for every number of this object.
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

/// Accuracy of a dot's displacement, by component [px^2].
struct CheckErrors {
  Vec2d scatter2;  ///< squared standard error of the mean correction by the traced rays
  Vec2d miss2;     ///< variance between rays of the table's error
};
/// Computes the errors from the scatter between independent scramblings, as displacement_error2().
/// @param of  sums of each scrambling
/// @param all  sum over all scramblings
GLADSTONE_HD inline CheckErrors check_errors(TableCheck const* of, int scramblings, TableCheck const& all) {
  Vec2d const miss = all.miss / all.rays;
  Vec2d scatter2{};
  for (int i = 0; i < scramblings; ++i) scatter2 += squares_of((of[i].miss - of[i].rays * miss) / all.rays);
  Vec2d const miss2 = all.miss2 / all.rays - squares_of(miss);
  return {error2_factor(scramblings) * scatter2, {miss2.x > 0 ? miss2.x : 0, miss2.y > 0 ? miss2.y : 0}};
}

/// Light cone of a dot according to the deflection table, corrected to agree with the traced rays on average.
class CorrectedCone {
 public:
  /// Distances from the aim in units of the stop's radius. Rays beyond `reach` are ignored. A table must cover rays up
  /// to `covered`, which suffices in fields that widen the cone by no more than a tenth; beyond, it is extrapolated.
  static constexpr double reach = 1.25, covered = 1.1;

  /// @param distance  from target to lens plane [m]
  /// @param centre  centre of the dot [m]
  /// @param aim  point of the pupil about which the cone is centred: the medium deflects the ray to this point into the
  ///   centre of the stop [m]
  GLADSTONE_HD CorrectedCone(DeflectionTable const& table, double stop_radius, double distance, Vec2d centre, Vec2d aim,
                             TableCheck const& check)
      : table_(table),
        stop_radius_(stop_radius),
        per_distance2_(1 / (distance * distance)),
        centre_(centre),
        aim_(aim) {
    if (!(check.rays > 0)) return;  // no traced rays: the dot's rays are not deflected
    shift_ = check.shift / check.rays;
    origin_ = check.traced / check.rays;
    miss_ = check.miss / check.rays;
    if (check.rays < fewest_rays) return;  // A few rays determine the mean, but not its variation over the cone.
    shift_by_x_ = (2 / check.square) * check.shift_by_x;
    shift_by_y_ = (2 / check.square) * check.shift_by_y;
    Vec2d const guess = origin_ - miss_;
    widening_[0] = (check.traced2[0] - check.expected2[0]) / check.rays - origin_.x * origin_.x + guess.x * guess.x;
    widening_[1] = (check.traced2[1] - check.expected2[1]) / check.rays - origin_.x * origin_.y + guess.x * guess.y;
    widening_[2] = (check.traced2[2] - check.expected2[2]) / check.rays - origin_.y * origin_.y + guess.y * guess.y;
  }

  /// Mean displacement of the traced rays, to which moments are relative [px].
  GLADSTONE_HD Vec2d origin() const { return origin_; }
  GLADSTONE_HD double stop_radius() const { return stop_radius_; }
  /// Returns the pupil point at this offset from the cone's centre [m].
  GLADSTONE_HD Vec2d pupil(Vec2d from_aim) const { return aim_ + from_aim; }

  /// Returns the distance from the aim, in a given direction, of the ray that arrives at the edge of the stop [m]; NaN
  /// if light crosses the edge more than once, or farther out than `reach`.
  /// @param offset  starting point of the ray relative to the dot's centre [m]
  GLADSTONE_HD double rim(Vec2d offset, Vec2d direction) const {
    using std::abs;
    // If the shift varies little over its own length, two fixed-point iterations with Aitken extrapolation suffice.
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

  /// Returns the displacement of a ray, relative to origin() [px].
  GLADSTONE_HD Vec2d displacement(Vec2d offset, Vec2d from_aim) const {
    if (!table_.exists()) return {};
    Vec2d const to = pupil(from_aim);
    return table_.displacement(table_.crossing(centre_ + offset, to), to) + miss_ - origin_;
  }
  /// Returns the intersection of a ray with the stop's plane, relative to the centre of the stop [m].
  GLADSTONE_HD Vec2d arrival(Vec2d offset, Vec2d from_aim) const {
    Vec2d const to = pupil(from_aim);
    if (!table_.exists()) return to;
    return to + table_.shift(table_.crossing(centre_ + offset, to), to) + shift_ + from_aim.x * shift_by_x_ +
           from_aim.y * shift_by_y_;
  }
  /// Returns cos^4 of the ray's angle at the target.
  GLADSTONE_HD double lambert(Vec2d offset, Vec2d pupil_point) const {
    Vec2d const across = pupil_point - centre_ - offset;
    double const spread = 1 + dot(across, across) * per_distance2_;
    return 1 / (spread * spread);
  }
  /// Normalises sums over the cone from one point of the source by its light in the reference image, and adds the
  /// difference in width between the traced and the tabulated rays.
  GLADSTONE_HD void finish(DisplacementMoments& moments, double without_medium) const {
    double const scale = 1 / without_medium;
    for (double& m : moments.of) m *= scale;
    for (int i = 0; i < 3; ++i) moments.of[DisplacementMoments::at(2, 0) + i] += moments.of[0] * widening_[i];
  }

 private:
  static constexpr double settled = 1e-6;    ///< tolerance of edge radii, relative to the stop's radius
  static constexpr double fewest_rays = 16;  ///< minimum number of rays to determine the variation of the table's error
  DeflectionTable table_;
  double stop_radius_, per_distance2_;
  Vec2d centre_, aim_, shift_{}, shift_by_x_{}, shift_by_y_{}, origin_{}, miss_{};
  double widening_[3] = {};

  /// Returns the radius at which a ray arrives at the edge of the stop if it is shifted like the ray at `radius` [m].
  GLADSTONE_HD double arriving(Vec2d offset, Vec2d direction, double radius) const {
    using std::sqrt;
    Vec2d const moved = arrival(offset, radius * direction) - radius * direction;
    double const along = dot(moved, direction);
    return sqrt(stop_radius_ * stop_radius_ - dot(moved, moved) + along * along) - along;
  }
  /// Finds the radius by a scan up to `reach` followed by regula falsi; NaN unless the edge is crossed exactly once.
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
      // Regula falsi, limited to 5 to 95 % of the interval so that both ends converge.
      double const share = below / (below - above);
      double const inner = share < 0.05 ? 0.05 : (share > 0.95 ? 0.95 : share);
      double const radius = low + inner * (high - low), here = outside(radius);
      if (here <= 0) {
        low = radius, below = here;
      } else {
        high = radius, above = here;
      }
    }
    // Return the root of the secant, which is continuous where rounding changes the number of iterations.
    return low + below / (below - above) * (high - low);
  }
  GLADSTONE_HD static double undefined() { return std::numeric_limits<double>::quiet_NaN(); }
};

/// Contribution of one node of a cone's rule.
struct ConeLight {
  Vec2d displacement;     ///< displacement relative to the cone's origin [px]
  double weight;          ///< light in the measurement image
  double without_medium;  ///< light in the reference image
};

/// Evaluates a node of the rule.
/// @param offset  point of the source relative to the dot's centre [m]
/// @param rims  radii of the stop's edge in the rule's directions, as seen from that point: the nodes fill the area
///   inside. Null if the edge is not single-valued, near a caustic: the points then fill the disc of radius `reach`,
///   and the edge of the stop is smoothed as for rays
GLADSTONE_HD inline ConeLight cone_light(CorrectedCone const& cone, ConeRule const& rule, int point, Vec2d offset,
                                         double const* rims) {
  if (!rims) {
    constexpr double wide = CorrectedCone::reach;
    ApertureStop<double> const stop{cone.stop_radius(), rule.smoothing};
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

}  // namespace gladstone::inline focused_dots
