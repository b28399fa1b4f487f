#pragma once

#include "render/focused_dots/dot_cone.h"
#include "render/focused_dots/moment_images.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_budget.h"
#include "render/scene/ray_hit.h"
#include "render/scene/spot.h"

/// Computation of a dot's truth and light from its light cone, for all devices.
namespace gladstone::inline focused_dots {

/// Method by which a dot is rendered.
enum class DotKind : int {
  left,    ///< fallback: rendered by the general renderer, since rays are lost or the table does not cover its cone
  still,   ///< no ray meets the medium: the same image in both frames
  narrow,  ///< light from the moments of the displacements of its cone about their mean
  wide,    ///< light from moments as for `narrow`, separately for each of several squares of displacement
};

/// Imaging model for the dots of a scene.
///
/// A thin lens focused on the target images all rays of a source point onto one image point, so the reference image is
/// the source's disc convolved with the PSF. For the measurement image, a deflection table gives the deflection of
/// every ray of a dot's light cone, corrected by a few traced rays of each dot (CorrectedCone). The truth is an
/// integral over the cone, and the light is computed from the moments of its displacements instead of PSFs of
/// individual rays.
///
/// Errors of the cone rule and the table beyond the mean, the width and the tilt of the shift, which the rays correct,
/// do not decrease with the number of rays; measure_table_error() measures them.
struct DotModel {
  Vec2d axis_px{};            ///< intersection of the optical axis with the sensor [px]
  int columns = 0, rows = 0;  ///< size of the sensor [px]
  double source_half = 0;     ///< radius of a dot, or half the side of a pixel of an image target [m]
  double stop_radius = 1;     ///< radius of the entrance pupil [m]
  double dot_light = 0;       ///< light of a white dot, without cos^4 [fully lit px]
  FocusedSetupView bench;
  GaussianSpot<double> spot;
  CubatureView source;
  DeflectionTable table;
  ConeRule cone;
  PlaceRule places;
  MomentImages moment_images;
  int fewest_rays = 0, most_rays = 0;  ///< limits of the number of rays per dot
  BundleView choice;                   ///< choice of the rays' sampling points
  SourceShape shape = SourceShape::disc;

  /// Number of scramblings to which the rays are assigned in turn.
  GLADSTONE_HD int scramblings() const { return 1 << choice.scrambling_bits; }

  GLADSTONE_HD double distance() const { return bench.lens_z - bench.plane_z; }
  GLADSTONE_HD double half_size_px() const { return source_half * bench.px_per_metre; }
  /// Returns the pixel position of the chief ray of a target point without medium [px].
  GLADSTONE_HD Vec2d to_pixel(Vec2d on_target) const {
    return {axis_px.x + bench.px_per_metre * on_target.x, axis_px.y - bench.px_per_metre * on_target.y};
  }
  /// Returns true if a pixel position is within the sensor's area.
  GLADSTONE_HD bool sees(Vec2d pixel) const {
    return pixel.x >= -0.5 && pixel.x < columns - 0.5 && pixel.y >= -0.5 && pixel.y < rows - 0.5;
  }
  /// Returns the light of a dot in the reference image [fully lit px].
  GLADSTONE_HD double reference_light(Vec2d centre, double radiance) const {
    double const spread = 1 + (dot(centre, centre) + 0.5 * stop_radius * stop_radius) / (distance() * distance());
    return dot_light * radiance / (spread * spread);
  }
  /// Maximum number of nodes over which a cone is integrated, for all points of the source.
  int most_points() const {
    return places.count * (cone.count > cone.scattered_count ? cone.count : cone.scattered_count);
  }
  /// Number of edge radii with which a cone is integrated.
  int rim_count() const { return places.count * cone.direction_count; }
  /// Returns the offset on the target of a position on the source, relative to its centre [m].
  GLADSTONE_HD Vec2d offset(Vec2d place) const { return {source_half * place.x, -source_half * place.y}; }
  /// Maximum side of the squares into which wide distributions of displacements are sorted [px], such that moments up
  /// to fourth order suffice in each.
  /// The series is in powers of displacement over sigma. Convolution with the pixel reduces the remainder but does not
  /// shorten the series, and a disc, whose edge alone is blurred by the PSF, allows larger squares than a point. Error
  /// for Table 1 (Rajendran et al. 2019): 2e-5 of the peak, rms over lit pixels, 1e-4 at most.
  GLADSTONE_HD double most_square_side() const {
    using std::sqrt;
    double const blur = sqrt(spot.sigma * spot.sigma + 1.0 / 12), allowed = (source_half > 0 ? 1.5 : 1.0) * spot.sigma;
    return blur < allowed ? blur : allowed;
  }
  /// Returns true if moments up to fourth order about the mean reproduce the light of the whole distribution to 1e-4 of
  /// the peak.
  GLADSTONE_HD bool narrow(DisplacementMoments const& moments) const {
    double const sigma2 = spot.sigma * spot.sigma, blur2 = 0.16 * (sigma2 + 1.0 / 12);
    double const allowed = (source_half > 0 ? 0.33 : 0.15) * sigma2;
    return moments.square() <= (blur2 < allowed ? blur2 : allowed) * moments.of[0];
  }
  /// Returns the squared standard error of the truth by component [px^2]: scatter of the rays' correction plus the
  /// systematic error of table and rule.
  /// The systematic error is a fraction of the ray-to-ray standard deviation of the table's error. Compared with
  /// 131,072 traced rays per dot, this fraction is 0.03 to 0.04 on both DNS planes, also for up to four times the
  /// density of the early one, and less than half of that with a rule twice as fine. With a smoothed edge of the stop,
  /// the error also increases with the square of that standard deviation over the width of the cone in the image. The
  /// edge radii, corrected by the same rays, add 1e-6 to 2e-6 px.
  GLADSTONE_HD Vec2d error2(CheckErrors const& errors, bool simple_edge = true) const {
    double const cone_px = 2 * table.mid_plane_fraction * stop_radius * bench.px_per_metre;
    double const leaves = simple_edge && cone.fine ? 0.015 : 0.04, folds = simple_edge ? 0 : 80 / cone_px;
    auto const left2 = [&](double miss2) { return (leaves * leaves + folds * folds * miss2) * miss2; };
    constexpr double rims2 = 2e-6 * 2e-6;
    return errors.scatter2 + Vec2d{left2(errors.miss2.x) + rims2, left2(errors.miss2.y) + rims2};
  }
  /// Returns true if the traced number of rays suffices.
  GLADSTONE_HD bool enough(CheckErrors const& errors, int traced) const {
    Vec2d const square = error2(errors);
    return traced >= most_rays || square.x + square.y <= 2 * truth_tolerance_px * truth_tolerance_px;
  }
};

/// Centre of a dot's light cone in the pupil.
struct DotAim {
  DotKind kind = DotKind::left;  ///< left, still, or narrow if the table covers the cone
  Vec2d pupil{};                 ///< pupil point of the ray that the medium deflects into the pupil's centre [m]
  double farthest = 0;           ///< largest distance of any iterate from the axis, which the table must cover [m]
};

/// Returns the shift of a dot's rays on the lens plane [m], averaged over nine rays: one to the aim and eight on a ring
/// about it.
/// @pre the table covers these rays
GLADSTONE_HD inline Vec2d mean_shift(DotModel const& model, Vec2d centre, Vec2d aim) {
  Vec2d sum{};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      // offset along each axis, in radii of the stop, so that the eight outer points are 0.7 radii from the centre
      double const away = x != 0 && y != 0 ? 0.5 : 0.7;
      Vec2d const pupil = aim + (away * model.stop_radius) * Vec2d{static_cast<double>(x), static_cast<double>(y)};
      sum += model.table.shift(model.table.crossing(centre, pupil), pupil);
    }
  }
  return sum / 9.0;
}

/// Aims at a dot by fixed-point iteration: finds the pupil point whose ray the medium deflects into the pupil's centre.
/// If this does not converge in eight iterations, near a caustic, the mean shift of the dot's rays is used instead of
/// that of the single ray.
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

/// Sampling points of a ray: its start on the source, relative to the centre in units of the half size, and its point
/// of the stop, in units of the radius.
struct DotRay {
  Vec2d place, at;

  GLADSTONE_HD static DotRay choose(BundleView const& choice, SourceShape shape, Vec2d centre, int k) {
    using std::sqrt;
    double u[sobol_dimensions];
    sample_coordinates(choice, random_key(centre), static_cast<std::uint64_t>(k), u);
    return {shape == SourceShape::disc ? point_on_circle(sqrt(u[2]), u[3]) : Vec2d{2 * u[2] - 1, 2 * u[3] - 1},
            point_on_circle(sqrt(u[0]), u[1])};
  }
};

}  // namespace gladstone::inline focused_dots
