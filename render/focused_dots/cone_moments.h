#pragma once

#include "render/focused_dots/deflection_table.h"
#include "render/focused_dots/displacement_moments.h"
#include "render/focused_dots/ray_record.h"
#include "render/scene/ground_truth.h"

/// Truth and light of a dot from the whole cone of its rays: the deflection table says what each would do, the rays
/// that were traced correct it. Integrals over the cone are then as good as their rule, with few rays a dot; the rule
/// follows waves of three of the field's finest lengths, in cones up to some hundred of them wide.
namespace gladstone {

/// Points of a cone's cross-section, in units of the stop's radius, on rings that share their directions.
struct ConePoint {
  double radius;
  double weight;  ///< share of the area
  int direction;
};
struct ConeRule {
  static constexpr int most_directions = 128;
  ConePoint const* points = nullptr;
  Vec2d const* directions = nullptr;
  int count = 0;
  int direction_count = 0;
  bool fine = false;  ///< twice as fine as usual

  // where a cone has no simple edge: points of equal weights all over the disc that rays are sent to
  Vec2d const* scattered = nullptr;
  int scattered_count = 0;
  double smoothing = 0;  ///< of the stop's edge, as ApertureStop::edge
};

/// What the traced rays of a dot say of the table: sums over rays.
struct TableCheck {
  double rays = 0;                            ///< that leave the medium
  Vec2d bend{}, bend_by_x{}, bend_by_y{};     ///< traced minus table [m]; times the pupil point [m^2]
  double pupil2 = 0;                          ///< |pupil point|^2 [m^2]
  double weight = 0;                          ///< of rays that pass the stop in the flow
  Vec2d traced{}, expected{};                 ///< their displacements, by tracing and by the table [px]
  double traced2[3] = {}, expected2[3] = {};  ///< their products xx, xy, yy [px^2]
  Vec2d miss2{};                              ///< squares of what the table is off by, by component [px^2]

  /// @param from where the ray starts on the target [m] @param hit its displacement from flow_displacement()
  GLADSTONE_HD void add(DeflectionTable const& table, Vec2d from, Vec2d hit, RayRecord<double> const& ray) {
    if (!ray.leaves_medium) return;
    Vec2d const crossing = table.crossing(from, ray.pupil);
    Vec2d const miss = ray.bend() - table.bend(crossing, ray.pupil);
    rays += 1;
    bend += miss;
    bend_by_x += ray.pupil.x * miss;
    bend_by_y += ray.pupil.y * miss;
    pupil2 += dot(ray.pupil, ray.pupil);
    if (ray.flow_weight == 0) return;
    double const w = ray.flow_weight;
    Vec2d const guess = table.displacement(crossing, ray.pupil);
    weight += w;
    traced += w * hit;
    expected += w * guess;
    Vec2d const off = hit - guess;
    miss2 += w * Vec2d{off.x * off.x, off.y * off.y};
    add_products(traced2, w, hit);
    add_products(expected2, w, guess);
  }
  GLADSTONE_HD TableCheck& operator+=(TableCheck const& o) {
    rays += o.rays;
    bend += o.bend;
    bend_by_x += o.bend_by_x;
    bend_by_y += o.bend_by_y;
    pupil2 += o.pupil2;
    weight += o.weight;
    traced += o.traced;
    expected += o.expected;
    miss2 += o.miss2;
    for (int i = 0; i < 3; ++i) {
      traced2[i] += o.traced2[i];
      expected2[i] += o.expected2[i];
    }
    return *this;
  }

 private:
  GLADSTONE_HD static void add_products(double (&sum)[3], double w, Vec2d d) {
    sum[0] += w * d.x * d.x;
    sum[1] += w * d.x * d.y;
    sum[2] += w * d.y * d.y;
  }
};

/// The cone of a dot's rays by the table, corrected to agree with the traced rays on average.
class CorrectedCone {
 public:
  /// @param sent_radius of the disc that rays are sent to [m] @param distance target to lens plane [m]
  /// @param centre of the dot [m]
  GLADSTONE_HD CorrectedCone(DeflectionTable const& table, double stop_radius, double sent_radius, double distance,
                             Vec2d centre, TableCheck const& check)
      : table_(table),
        stop_radius_(stop_radius),
        sent_radius_(sent_radius),
        per_stop_radius_(1 / stop_radius),
        per_distance2_(1 / (distance * distance)),
        centre_(centre),
        bend_(check.bend / check.rays),
        bend_by_x_((2 / check.pupil2) * check.bend_by_x),
        bend_by_y_((2 / check.pupil2) * check.bend_by_y),
        origin_(check.traced / check.weight),
        miss_(origin_ - check.expected / check.weight) {
    // a handful of rays tells the mean, not how it varies
    if (check.rays < fewest_rays) {
      bend_by_x_ = bend_by_y_ = {};
      widening_[0] = widening_[1] = widening_[2] = 0;
      return;
    }
    Vec2d const guess = origin_ - miss_;
    widening_[0] = (check.traced2[0] - check.expected2[0]) / check.weight - origin_.x * origin_.x + guess.x * guess.x;
    widening_[1] = (check.traced2[1] - check.expected2[1]) / check.weight - origin_.x * origin_.y + guess.x * guess.y;
    widening_[2] = (check.traced2[2] - check.expected2[2]) / check.weight - origin_.y * origin_.y + guess.y * guess.y;
  }

  /// Mean displacement of the traced rays: where moments count from [px].
  GLADSTONE_HD Vec2d origin() const { return origin_; }
  /// A radius of the pupil in units of the stop's.
  GLADSTONE_HD double of_stop(double radius) const { return radius * per_stop_radius_; }
  GLADSTONE_HD double stop_radius() const { return stop_radius_; }
  /// Of the disc that rays are sent to [m].
  GLADSTONE_HD double sent_radius() const { return sent_radius_; }

  /// Distance from the pupil's middle, in a direction, of the ray from a place of the source that arrives at the
  /// stop's edge [m]; NaN where light crosses the edge more than once, or further out than rays were sent.
  /// @param offset of the place from the dot's centre [m]
  GLADSTONE_HD double rim(Vec2d offset, Vec2d direction) const {
    using std::abs;
    // where bends change little within their own length two looks do, as if their change went on (Aitken)
    double const first = arriving(offset, direction, stop_radius_);
    if (!(first <= sent_radius_)) return undefined();
    double const second = arriving(offset, direction, first);
    double const change = first - stop_radius_, last = second - first;
    if (abs(change) <= settled * stop_radius_) return second;
    if (!(abs(last) <= 0.1 * abs(change)) || !(abs(last) <= 1e-3 * stop_radius_)) {
      return searched_rim(offset, direction);
    }
    double const radius = second + last * last / (change - last);
    return radius <= sent_radius_ ? radius : undefined();
  }

  /// Displacement of a ray, counted from origin() [px].
  GLADSTONE_HD Vec2d displacement(Vec2d offset, Vec2d pupil) const {
    return table_.displacement(table_.crossing(centre_ + offset, pupil), pupil) + miss_ - origin_;
  }
  /// How far a ray arrives from its pupil point [m].
  GLADSTONE_HD Vec2d bend(Vec2d offset, Vec2d pupil) const {
    return table_.bend(table_.crossing(centre_ + offset, pupil), pupil) + bend_ + pupil.x * bend_by_x_ +
           pupil.y * bend_by_y_;
  }
  /// As ApertureStop::transmission.
  GLADSTONE_HD double transmission(Vec2d arrival, double smoothing) const {
    return ApertureStop<double>{0, stop_radius_, smoothing}.transmission(arrival.x, arrival.y);
  }
  /// cos^4 of the angle at which a ray leaves the target.
  GLADSTONE_HD double lambert(Vec2d offset, Vec2d pupil) const {
    Vec2d const across = pupil - centre_ - offset;
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
  double stop_radius_, sent_radius_, per_stop_radius_, per_distance2_;
  Vec2d centre_, bend_, bend_by_x_, bend_by_y_, origin_, miss_;
  double widening_[3];

  /// Radius at which a ray would have to be sent to arrive at the stop's edge, bent as one at `radius` is.
  GLADSTONE_HD double arriving(Vec2d offset, Vec2d direction, double radius) const {
    using std::sqrt;
    Vec2d const moved = bend(offset, radius * direction);
    double const along = dot(moved, direction);
    return sqrt(stop_radius_ * stop_radius_ - dot(moved, moved) + along * along) - along;
  }
  /// By how much a ray to a pupil point arrives outside the stop's edge [m].
  GLADSTONE_HD double outside(Vec2d offset, Vec2d pupil) const {
    return length(pupil + bend(offset, pupil)) - stop_radius_;
  }
  /// Looks along the direction as far as bends may reach, and closes in on the one place where the edge is crossed.
  GLADSTONE_HD double searched_rim(Vec2d offset, Vec2d direction) const {
    constexpr int looks = 12;
    double const margin = sent_radius_ - stop_radius_, step = 2 * margin / looks;
    double low = 0, below = 0, high = 0, above = 0, last = 0;
    for (int look = 0; look <= looks; ++look) {
      double const radius = stop_radius_ - margin + look * step;
      double const here = outside(offset, radius * direction);
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
      double const radius = low + inner * (high - low), here = outside(offset, radius * direction);
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

/// @param rims of the rule's directions, from a place of the source: the points fill what they enclose
GLADSTONE_HD inline ConeLight cone_light(CorrectedCone const& cone, ConeRule const& rule, int point, Vec2d offset,
                                         double const* rims) {
  ConePoint const at = rule.points[point];
  Vec2d const direction = rule.directions[at.direction];
  double const rim = rims[at.direction], widened = cone.of_stop(rim);
  Vec2d const pupil = (at.radius * rim) * direction;
  return {cone.displacement(offset, pupil), at.weight * widened * widened * cone.lambert(offset, pupil),
          at.weight * cone.lambert(offset, (at.radius * cone.stop_radius()) * direction)};
}

/// The same where the stop's edge has no single rim as seen from the source, near a caustic: the points fill all of the
/// pupil that rays are sent to, and the stop's edge is smoothed as it is for rays.
GLADSTONE_HD inline ConeLight smoothed_light(CorrectedCone const& cone, ConeRule const& rule, int point, Vec2d offset) {
  double const widened = cone.of_stop(cone.sent_radius());
  Vec2d const pupil = cone.sent_radius() * rule.scattered[point];
  double const weight = widened * widened / rule.scattered_count * cone.lambert(offset, pupil);
  return {cone.displacement(offset, pupil),
          weight * cone.transmission(pupil + cone.bend(offset, pupil), rule.smoothing),
          weight * cone.transmission(pupil, rule.smoothing)};
}

/// Adds what one place of a source shows to the sums of truth.
/// @param at of the place's image [px] @param weight in the reference frame @param moments shares, about `origin`
GLADSTONE_HD inline void add_place(CentroidSum<double>& reference, CentroidSum<double>& flow, Vec2d at, double weight,
                                   DisplacementMoments const& moments, Vec2d origin) {
  using M = DisplacementMoments;
  reference.add(at, weight, false);
  Vec2d const moved = at + origin, mean{moments.of[M::at(1, 0)], moments.of[M::at(0, 1)]};
  double const all = moments.of[0];
  flow.weight += weight * all;
  flow.first += weight * (all * moved + mean);
  flow.second += weight * Vec2d{all * moved.x * moved.x + 2 * moved.x * mean.x + moments.of[M::at(2, 0)],
                                all * moved.y * moved.y + 2 * moved.y * mean.y + moments.of[M::at(0, 2)]};
}

}  // namespace gladstone
