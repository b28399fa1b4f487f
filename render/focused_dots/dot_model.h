#pragma once

#include "render/focused_dots/dot_cone.h"
#include "render/focused_dots/moment_images.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"
#include "render/scene/ray_plan.h"
#include "render/scene/spot.h"

/// How a dot's truth and light come from its cone, for every device.
namespace gladstone {

/// Points of a unit disc (or square) with weights of sum one, as a view.
struct CubatureView {
  Vec2d const* points = nullptr;  ///< in units of the half size
  double const* weights = nullptr;
  int count = 0;
};

/// What becomes of a dot.
enum class DotKind : int {
  left,    ///< to the general renderer: the table does not cover its cone, or rays of it get lost, or cross
  still,   ///< none of its rays meets the medium: one image in both frames
  narrow,  ///< its light goes by the moments of its cone about their mean
  wide,    ///< by moments, square by square of displacement
};

/// How the dots of a scene are seen.
///
/// A thin lens focused on the target maps every ray of a source's point on one image point, so the reference image is
/// the source's disc convolved with the spot. In the flow a table of deflections tells what every ray of a dot's cone
/// does; a few rays of each dot are traced and correct it (CorrectedCone). Truth is an integral over the cone, and light
/// goes by the moments of its displacements; no spot is laid down for a ray. What the rule over the cone and the table
/// are off by beyond the rays' mean, their spread and a tilt of the bend stays, whatever the number of rays:
/// table_error() measures it.
struct DotModel {
  Vec2d axis_px{};            ///< where the optical axis meets the sensor [px]
  int columns = 0, rows = 0;  ///< of the sensor
  double source_half = 0;     ///< radius of a dot, half the side of a picture's pixel [m]
  double stop_radius = 1;     ///< [m]
  double dot_light = 0;       ///< of a white dot, but for cos^4 [fully lit px]
  BenchView bench;
  GaussianSpot<double> spot;
  CubatureView source;
  DeflectionTable table;
  ConeRule cone;
  PlaceRule places;
  MomentImages moment_images;
  CheckRay const* rays = nullptr;  ///< that a dot may have
  int fewest_rays = 0, most_rays = 0;
  int scramblings = 1;  ///< that they are dealt to in turn

  GLADSTONE_HD double distance() const { return bench.lens_z - bench.plane_z; }
  GLADSTONE_HD double half_size_px() const { return source_half * bench.px_per_metre; }
  /// Where the chief ray of a point of the target ends without medium [px].
  GLADSTONE_HD Vec2d to_pixel(Vec2d on_target) const {
    return {axis_px.x + bench.px_per_metre * on_target.x, axis_px.y - bench.px_per_metre * on_target.y};
  }
  /// Light of a dot in the reference frame [fully lit px].
  GLADSTONE_HD double light_of(Vec2d centre, double radiance) const {
    double const spread = 1 + (dot(centre, centre) + 0.5 * stop_radius * stop_radius) / (distance() * distance());
    return dot_light * radiance / (spread * spread);
  }
  /// From the centre of the source to a place on it [m].
  GLADSTONE_HD Vec2d offset(Vec2d place) const { return {source_half * place.x, -source_half * place.y}; }
  /// Most side of the squares into which wide distributions of displacements are sorted [px], within which four orders
  /// of moments do. The series runs in displacements over sigma; a pixel blurs what it leaves but does not shorten it,
  /// and a disc, of which a spot is but the rim's blur, allows more than a point. Table 1: 2e-5 of the peak, rms over
  /// lit pixels, 1e-4 at worst.
  GLADSTONE_HD double most_box_side() const {
    using std::sqrt;
    double const blur = sqrt(spot.sigma * spot.sigma + 1.0 / 12), allowed = (source_half > 0 ? 1.5 : 1.0) * spot.sigma;
    return blur < allowed ? blur : allowed;
  }
  /// Whether four orders of moments about the mean give a spot to 1e-4 of its peak for all of a distribution.
  GLADSTONE_HD bool narrow(DisplacementMoments const& moments) const {
    double const sigma2 = spot.sigma * spot.sigma, blur2 = 0.16 * (sigma2 + 1.0 / 12);
    double const allowed = (source_half > 0 ? 0.33 : 0.15) * sigma2;
    return moments.square() <= (blur2 < allowed ? blur2 : allowed) * moments.of[0];
  }
  /// Squares of standard errors of truth [px^2], what the table leaves of every ray alike included: a share of the
  /// scatter, from ray to ray, of what it is off by. Measured on both DNS planes against 131,072 rays alone: 0.03 to
  /// 0.04 of it, less than half of that with a rule twice as fine.
  GLADSTONE_HD Vec2d error2(CheckErrors const& errors) const {
    double const leaves = cone.fine ? 0.015 : 0.04;
    return errors.scatter2 + (leaves * leaves) * errors.miss2;
  }
  /// Whether so many rays of a dot are enough.
  GLADSTONE_HD bool enough(CheckErrors const& errors, int traced) const {
    Vec2d const square = error2(errors);
    return traced >= most_rays || square.x + square.y <= 2 * truth_tolerance_px * truth_tolerance_px;
  }
};

/// Where a dot's cone lies.
struct DotAim {
  DotKind kind = DotKind::left;  ///< left, still, or narrow for what the table covers
  Vec2d pupil{};                 ///< point of the pupil whose ray arrives at its middle [m]
  double farthest = 0;           ///< from the axis that was aimed at, for a table that ends there [m]
};

/// Aims at a dot: its ray to the pupil's middle is bent aside, so that it is aimed at again, and again.
GLADSTONE_HD inline DotAim aim_dot(DotModel const& model, Vec2d centre) {
  constexpr int most_rounds = 30;
  DeflectionTable const& table = model.table;
  double const half = 1.5 * model.source_half, reach = CorrectedCone::reach * model.stop_radius;
  DotAim aim;
  if (table.beside(centre, half, reach)) {
    aim.kind = DotKind::still;
    return aim;
  }
  for (int round = 0; round < most_rounds; ++round) {
    double const far = length(aim.pupil);
    if (far > aim.farthest) aim.farthest = far;
    if (!table.covers(centre, half, aim.pupil, reach)) return aim;
    Vec2d const last = aim.pupil;
    aim.pupil = -table.bend(table.crossing(centre, last), last);
    if (length(aim.pupil - last) > 1e-9 * model.stop_radius) continue;
    if (table.covers(centre, half, aim.pupil, reach)) aim.kind = DotKind::narrow;
    return aim;
  }
  return aim;
}

/// What tracing a dot's rays says.
struct CheckedRay {
  Vec2d at;  ///< of the stop, from its middle, but for what the medium bends further [m]
  Deflection expected;
  RayStatus status[frame_count];  ///< where it ends in either frame
};

/// Where check ray k of a dot starts and what it is sent to.
struct SentRay {
  Vec2d from, pupil;
};
GLADSTONE_HD inline SentRay send_ray(DotModel const& model, Vec2d centre, Vec2d aim, int k) {
  CheckRay const ray = model.rays[k];
  return {centre + model.offset(ray.place), aim + model.stop_radius * ray.at};
}
/// Compares it with the table.
GLADSTONE_HD inline CheckedRay check_ray(DotModel const& model, Vec2d aim, SentRay const& sent,
                                         Deflection const& found) {
  CheckedRay checked;
  checked.at = sent.pupil - aim;
  Vec2d const crossing = model.table.crossing(sent.from, sent.pupil);
  checked.expected = {model.table.displacement(crossing, sent.pupil), model.table.bend(crossing, sent.pupil)};
  for (int frame = 0; frame < frame_count; ++frame) {
    Vec2d pixel = model.to_pixel(sent.from), arrival = sent.pupil;
    if (frame == 1) pixel += found.displacement, arrival += found.bend;
    bool const seen = pixel.x >= -0.5 && pixel.x < model.columns - 0.5 && pixel.y >= -0.5 && pixel.y < model.rows - 0.5;
    checked.status[frame] = length(arrival) > model.stop_radius ? RayStatus::vignetted
                            : seen                              ? RayStatus::alive
                                                                : RayStatus::missed_sensor;
  }
  if (found.status != RayStatus::alive) checked.status[1] = found.status;
  return checked;
}

/// Adds what one place of a source shows to the sums of truth.
/// @param at of the place's image [px] @param weight in the reference frame @param moments shares, about `origin`
GLADSTONE_HD inline void add_place(DotTruth& truth, Vec2d at, double weight, DisplacementMoments const& moments,
                                   Vec2d origin) {
  using M = DisplacementMoments;
  truth.hits[0].add(at, weight, false);
  CentroidSum<double>& flow = truth.hits[1];
  Vec2d const moved = at + origin, mean{moments.of[M::at(1, 0)], moments.of[M::at(0, 1)]};
  double const all = moments.of[0];
  flow.weight += weight * all;
  flow.first += weight * (all * moved + mean);
  flow.second += weight * Vec2d{all * moved.x * moved.x + 2 * moved.x * mean.x + moments.of[M::at(2, 0)],
                                all * moved.y * moved.y + 2 * moved.y * mean.y + moments.of[M::at(0, 2)]};
}

/// A dot's truth from its cone. @param light of the dot [fully lit px]
/// @param moments,without_medium of the whole cone at every place of the source
GLADSTONE_HD inline void sum_cone(DotModel const& model, double light, Vec2d origin, DisplacementMoments const* moments,
                                  double const* without_medium, DotTruth& truth) {
  PlaceRule const& rule = model.places;
  double all = 0;
  for (int i = 0; i < rule.count; ++i) all += rule.weights[i] * without_medium[i];
  for (int i = 0; i < rule.count; ++i) {
    double const share = rule.weights[i] * without_medium[i] / all;
    add_place(truth, model.half_size_px() * rule.places[i], light * share, moments[i], origin);
  }
}

/// How the light of a dot in the flow goes whose cone the table covers. @param narrow its moments are, at all places
/// @param origin image of its centre, moved by what its rays are on average [px] @param extent of displacements about it
GLADSTONE_HD inline DotKind wide_or_narrow(DotModel const& model, bool narrow, Vec2d origin, Extent const& extent) {
  if (narrow) return DotKind::narrow;
  MomentImages const& images = model.moment_images;
  return images.exist() && SpannedBoxes(images.lattice, origin, extent).few ? DotKind::wide : DotKind::left;
}

/// Some light to be laid down around a point.
struct Deposit {
  Vec2d at{};       ///< [px]
  double weight{};  ///< 0: nothing
};
/// Light that the i-th point of the source leaves in the reference frame. @param origin image of its centre [px]
GLADSTONE_HD inline Deposit reference_light(DotModel const& model, Vec2d origin, double light, int i) {
  return {origin + model.half_size_px() * model.source.points[i], light * model.source.weights[i]};
}

}  // namespace gladstone
