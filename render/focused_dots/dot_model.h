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
  left,    ///< to the general renderer: the table does not cover its cone, or rays of it get lost
  still,   ///< none of its rays meets the medium: one image in both frames
  narrow,  ///< its light goes by the moments of its cone about their mean
  wide,    ///< by moments, square by square of displacement
};

/// How the dots of a scene are seen.
///
/// A thin lens focused on the target maps every ray of a source's point on one image point, so the reference image is
/// the source's disc convolved with the spot. In the flow a table of deflections tells what every ray of a dot's cone
/// does; a few rays of each dot are traced and correct it (CorrectedCone). Truth is an integral over the cone, and
/// light goes by the moments of its displacements; no spot is laid down for a ray. What the rule over the cone and the
/// table are off by beyond the rays' mean, their spread and a tilt of the shift stays, whatever the number of rays:
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
  int fewest_rays = 0, most_rays = 0;  ///< of a dot
  BundleView<double> choice;           ///< of them
  SourceShape shape = SourceShape::disc;

  /// That the rays are dealt to in turn.
  GLADSTONE_HD int scramblings() const { return 1 << choice.scrambling_bits; }

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
  /// Points that a cone may be integrated over, at all places of the source.
  int most_points() const {
    return places.count * (cone.count > cone.scattered_count ? cone.count : cone.scattered_count);
  }
  /// From the centre of the source to a place on it [m].
  GLADSTONE_HD Vec2d offset(Vec2d place) const { return {source_half * place.x, -source_half * place.y}; }
  /// Most side of the squares into which wide distributions of displacements are sorted [px], within which four orders
  /// of moments do. The series runs in displacements over sigma; a pixel blurs what it leaves but does not shorten it,
  /// and a disc, of which a spot is but the rim's blur, allows more than a point. Table 1: 2e-5 of the peak, rms over
  /// lit pixels, 1e-4 at worst.
  GLADSTONE_HD double most_square_side() const {
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
  /// 0.04 of it, less than half of that with a rule twice as fine, and where the stop's edge is smoothed more with the
  /// square of the scatter over the width of the cone as the target shows it: up to four times the early plane's
  /// density. A millionth of a pixel or two comes from rims, which the same rays move.
  GLADSTONE_HD Vec2d error2(CheckErrors const& errors, bool simple_edge = true) const {
    double const cone_px = 2 * table.way * stop_radius * bench.px_per_metre;
    double const leaves = simple_edge && cone.fine ? 0.015 : 0.04, folds = simple_edge ? 0 : 80 / cone_px;
    auto const left2 = [&](double miss2) { return (leaves * leaves + folds * folds * miss2) * miss2; };
    constexpr double rims2 = 2e-6 * 2e-6;
    return errors.scatter2 + Vec2d{left2(errors.miss2.x) + rims2, left2(errors.miss2.y) + rims2};
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

/// Bend of a dot's rays about an aim, on average over middle and ring [m]. @pre the table covers them
GLADSTONE_HD inline Vec2d mean_shift(DotModel const& model, Vec2d centre, Vec2d aim) {
  Vec2d sum{};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      double const away = x != 0 && y != 0 ? 0.5 : 0.7;  // of the stop's radius
      Vec2d const pupil = aim + (away * model.stop_radius) * Vec2d{static_cast<double>(x), static_cast<double>(y)};
      sum += model.table.shift(model.table.crossing(centre, pupil), pupil);
    }
  }
  return sum / 9.0;
}

/// Aims at a dot: its ray to the pupil's middle is bent aside, so that it is aimed at again, and again; where that
/// comes to no end, near a caustic, as its rays are bent on average.
GLADSTONE_HD inline DotAim aim_dot(DotModel const& model, Vec2d centre) {
  constexpr int rounds_of_one = 8, most_rounds = 24;
  DeflectionTable const& table = model.table;
  double const half = (model.shape == SourceShape::disc ? 1.0 : 1.42) * model.source_half;
  double const reach = CorrectedCone::covered * model.stop_radius;
  DotAim aim;
  if (table.beside(centre, half, CorrectedCone::reach * model.stop_radius)) {
    aim.kind = DotKind::still;
    return aim;
  }
  for (int round = 0; round <= most_rounds; ++round) {
    double const far = length(aim.pupil);
    if (far > aim.farthest) aim.farthest = far;
    if (!table.covers(centre, half, aim.pupil, reach)) return aim;
    if (round == most_rounds) break;
    Vec2d const last = aim.pupil;
    bool const alone = round < rounds_of_one;
    aim.pupil = alone ? -table.shift(table.crossing(centre, last), last) : -mean_shift(model, centre, last);
    if (!(length(aim.pupil - last) > (alone ? 1e-6 : 0.01) * model.stop_radius)) {
      if (!table.covers(centre, half, aim.pupil, reach)) return aim;
      break;
    }
  }
  aim.kind = DotKind::narrow;
  return aim;
}

/// What tracing a dot's rays says.
struct CheckedRay {
  Vec2d at;  ///< of the stop, from its middle, but for what the medium shifts further [m]
  Deflection expected;
  RayStatus status[frame_count];  ///< where it ends in either frame
};

/// Where ray k of a dot starts, from its centre in units of its half size, and its point of a stop of radius one.
struct DotRay {
  Vec2d place, at;

  GLADSTONE_HD static DotRay choose(BundleView<double> const& choice, SourceShape shape, Vec2d centre, int k) {
    using std::sqrt;
    double u[sobol_dimensions];
    sample_coordinates(choice, key_of(centre), static_cast<std::uint64_t>(k), u);
    return {shape == SourceShape::disc ? point_of_circle(sqrt(u[2]), u[3]) : Vec2d{2 * u[2] - 1, 2 * u[3] - 1},
            point_of_circle(sqrt(u[0]), u[1])};
  }
};
/// Where it starts and what it is sent to [m].
struct SentRay {
  Vec2d from, pupil;
};
GLADSTONE_HD inline SentRay send_ray(DotModel const& model, Vec2d centre, Vec2d aim, int k) {
  DotRay const ray = DotRay::choose(model.choice, model.shape, centre, k);
  return {centre + model.offset(ray.place), aim + model.stop_radius * ray.at};
}
/// Compares it with the table.
GLADSTONE_HD inline CheckedRay check_ray(DotModel const& model, Vec2d aim, SentRay const& sent,
                                         Deflection const& found) {
  CheckedRay checked;
  checked.at = sent.pupil - aim;
  Vec2d const crossing = model.table.crossing(sent.from, sent.pupil);
  checked.expected = {model.table.displacement(crossing, sent.pupil), model.table.shift(crossing, sent.pupil)};
  for (int frame = 0; frame < frame_count; ++frame) {
    Vec2d pixel = model.to_pixel(sent.from), arrival = sent.pupil;
    if (frame == 1) pixel += found.displacement, arrival += found.shift;
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
/// @param origin image of its centre, moved by what its rays are on average [px] @param extent of displacements about
/// it
GLADSTONE_HD inline DotKind wide_or_narrow(DotModel const& model, bool narrow, Vec2d origin, Extent const& extent) {
  if (narrow) return DotKind::narrow;
  MomentImages const& images = model.moment_images;
  return images.exist() && SpannedSquares(images.lattice, origin, extent).few ? DotKind::wide : DotKind::left;
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
