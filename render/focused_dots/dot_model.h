#pragma once

#include "render/focused_dots/dot_cone.h"
#include "render/focused_dots/moment_images.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"
#include "render/scene/ray_plan.h"
#include "render/scene/spot.h"

/// How a dot's truth and light come from its cone, for every device.
namespace gladstone {

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
  /// Whether a place is on the sensor [px].
  GLADSTONE_HD bool sees(Vec2d pixel) const {
    return pixel.x >= -0.5 && pixel.x < columns - 0.5 && pixel.y >= -0.5 && pixel.y < rows - 0.5;
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
  /// Rims of the stop that a cone is integrated with.
  int rim_count() const { return places.count * cone.direction_count; }
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

}  // namespace gladstone
