#pragma once

#include "render/focused_dots/bench_theory.h"
#include "render/focused_dots/cone_moments.h"
#include "render/focused_dots/dot_error.h"
#include "render/focused_dots/flow_fit.h"
#include "render/focused_dots/moment_images.h"
#include "render/scene/spot.h"

/// How a dot's rays become light on the sensor, for every device: where light is to be laid down, and how much of it.
namespace gladstone {

/// Points of a unit disc (or square) with weights of sum one, as a view.
struct CubatureView {
  Vec2d const* points = nullptr;  ///< in units of the half size
  double const* weights = nullptr;
  int count = 0;
};

/// The rules over the stop, from one point on: the more the displacement varies across it, the finer. Each keeps what a
/// Gaussian spot of 0.25 px or more makes of the spread to 1e-5 of its peak.
inline constexpr int pupil_rules = 5;
GLADSTONE_HD inline int pupil_rule(double spread_px) {
  return spread_px == 0 ? 0 : (spread_px < 0.02 ? 1 : (spread_px < 0.2 ? 2 : (spread_px < 0.6 ? 3 : 4)));
}

/// How a dot's light is laid down.
enum class DotKind : int {
  still,   ///< the flow left it alone: one disc in both frames
  narrow,  ///< by the moments of its cone about their mean
  wide,    ///< by moments, square by square of displacement, where there are not too many; else ray by ray
  rays,    ///< ray by ray
};

/// How the images of all dots are made.
///
/// Where the reference frame is known in closed form (a thin lens focused on the target maps every ray of a source's
/// point on one image point, so the reference image is the source's disc convolved with the spot), the rays serve as a
/// control variate's remainder: the flow image is the same disc moved by a smooth fit to the rays' displacements, both
/// discs integrated by cubature, plus for every ray the spot where it lands minus the spot where the fit puts it.
/// Whatever the fit, this sum converges to the image that the rays alone would give; the better the fit, the less it
/// scatters. Elsewhere every ray's spot is laid down where it lands.
///
/// With a deflection table truth comes from integrals over the cone instead (CorrectedCone), and so does light where
/// the spot is Gaussian: the rays correct the table, and no spot is laid down for them. That does not converge with the
/// number of rays to what they alone would give: what the rule over the cone and the table are off by beyond the rays'
/// mean, their spread and a tilt of the bend stays, some 1e-4 px of truth and half a grey level of 12 bits. It is more
/// near caustics, where the stop's edge is no simple curve as seen from the dot and is smoothed: on the early DNS plane
/// with four times its density truth is off by 0.02 px. Truth's standard error includes it (table_leaves), and dots
/// whose rays do better by themselves are left to them (rays_are_better).
struct LightModel {
  TargetImage image;
  SpotView spot;
  bool controlled = false;
  double expected_weight = 0;  ///< sum of the weights of a dot's rays that pass the stop, expected, but for cos^4
  double mean_pupil2 = 0;      ///< mean |P|^2 over the stop [m^2]
  double distance = 0;         ///< target to lens plane [m]
  CubatureView source;
  CubatureView pupil[pupil_rules];
  DeflectionTable table;  ///< where it exists
  ConeRule cone;
  PlaceRule places;
  MomentImages moment_images;
  double sent_radius = 0;  ///< of the disc in the lens plane that rays are sent to [m]
  int scramblings = 1;     ///< that a dot's rays are dealt to in turn

  /// Whether light is laid down by moments where a dot's cone allows it.
  GLADSTONE_HD bool by_moments() const {
    return controlled && spot.model != SpotModel::airy && spot.model != SpotModel::none && spot.half_width() <= 22;
  }
  /// Most side of the squares into which wide distributions of displacements are sorted [px], within which four orders
  /// of moments do. The series runs in displacements over sigma; a pixel blurs what it leaves but does not shorten it,
  /// and a disc, of which a spot is but the rim's blur, allows more than a point. Table 1: 2e-5 of the peak, rms over
  /// lit pixels, 1e-4 at worst.
  GLADSTONE_HD double most_box_side() const {
    using std::sqrt;
    double const sigma = spot.gaussian.sigma, blur = sqrt(sigma * sigma + 1.0 / 12);
    double const allowed = (image.source_half > 0 ? 1.5 : 1.0) * sigma;
    return blur < allowed ? blur : allowed;
  }
  /// Whether four orders of moments about the mean give a spot to 1e-4 of its peak for all of a distribution.
  GLADSTONE_HD bool narrow(DisplacementMoments const& moments) const {
    double const sigma2 = spot.gaussian.sigma * spot.gaussian.sigma, blur2 = 0.16 * (sigma2 + 1.0 / 12);
    double const allowed = (image.source_half > 0 ? 0.33 : 0.15) * sigma2;
    return moments.square() <= (blur2 < allowed ? blur2 : allowed) * moments.of[0];
  }
  /// How a dot's light is laid down. @param moved the flow did something to some of its rays @param integrated its cone
  /// was, by the table @param narrow_cone narrow() at all places of the source
  GLADSTONE_HD DotKind kind(bool moved, bool integrated, bool narrow_cone) const {
    if (controlled && !moved) return DotKind::still;
    if (!integrated || !by_moments()) return DotKind::rays;
    if (narrow_cone) return DotKind::narrow;
    return moment_images.exist() ? DotKind::wide : DotKind::rays;
  }
  /// Whether the table knows all rays of a dot.
  GLADSTONE_HD bool tabled(Vec2d centre) const {
    return image.has_stop && table.covers(centre, 1.5 * image.source_half, sent_radius);
  }
  /// Whether a dot's rays say enough to correct the table: a fifth of them pass the stop in the flow.
  GLADSTONE_HD bool correctable(TableCheck const& check, double expected_weight_of_dot) const {
    return check.weight > 0.2 * expected_weight_of_dot;
  }
  /// Square of the standard error of truth by the table [px^2], what it leaves of every ray alike included: a share of
  /// the scatter, from ray to ray, of what it is off by. Measured on both DNS planes against 131,072 rays alone: 0.03
  /// to 0.04 of it, less than half of that with a rule twice as fine, and where the stop's edge is smoothed more with
  /// the square of the scatter over the width of the cone as the target shows it: up to four times the early plane's
  /// density.
  GLADSTONE_HD Vec2d table_error2(DotErrors const& errors, bool simple_edge) const {
    double const cone_px = 2 * table.way * image.stop_radius * image.px_per_metre;
    double const leaves = simple_edge && cone.fine ? 0.015 : 0.04, folds = simple_edge ? 0 : 80 / cone_px;
    auto const left2 = [&](double miss2) { return (leaves * leaves + folds * folds * miss2) * miss2; };
    return errors.table2 + Vec2d{left2(errors.miss2.x), left2(errors.miss2.y)};
  }
  /// Whether many rays are better by themselves.
  GLADSTONE_HD bool rays_are_better(DotErrors const& errors, TableCheck const& check, bool simple_edge) const {
    Vec2d const table2 = table_error2(errors, simple_edge);
    return check.rays >= 1024 && errors.rays2.x + errors.rays2.y < table2.x + table2.y;
  }
  /// Standard error of a dot's displacement. @param tabled its truth is the table's [px]
  GLADSTONE_HD Vec2d error(DotErrors const& errors, bool tabled, bool simple_edge) const {
    using std::sqrt;
    if (!image.has_stop && image.source_half == 0) return {};  // all rays of a dot are one
    Vec2d const square = tabled ? table_error2(errors, simple_edge) : errors.rays2;
    return {sqrt(square.x), sqrt(square.y)};
  }
  /// Points that a cone is integrated over at each place. @param simple_edge of the stop, as seen from all of them
  GLADSTONE_HD int cone_points(bool simple_edge) const { return simple_edge ? cone.count : cone.scattered_count; }
  GLADSTONE_HD CorrectedCone corrected(Vec2d centre, TableCheck const& check) const {
    return {table, image.stop_radius, sent_radius, distance, centre, check};
  }
  /// From the centre of the source to a place on it [m].
  GLADSTONE_HD Vec2d offset(Vec2d place) const { return {image.source_half * place.x, -image.source_half * place.y}; }
};

/// Some light to be laid down around a point.
struct Deposit {
  Vec2d at{};       ///< [px]
  double weight{};  ///< 0: nothing
};

/// What is known of a dot's light before its rays are traced.
struct DotPlan {
  Vec2d origin{};              ///< image of the dot's centre without medium [px]
  double expected_weight = 0;  ///< of all its rays that pass the stop

  GLADSTONE_HD static DotPlan make(LightModel const& model, Vec2d centre, double radiance) {
    double const spread = 1 + (dot(centre, centre) + model.mean_pupil2) / (model.distance * model.distance);
    return {model.image.to_pixel(centre), model.expected_weight * radiance / (spread * spread)};
  }
};

/// A dot's truth from its cone: sums over the places of the source, in place of those over its rays.
/// @param moments,without_medium of the whole cone at every place @param hits both frames'; keep their counts of rays
GLADSTONE_HD inline void sum_cone(LightModel const& model, DotPlan const& plan, Vec2d origin,
                                  DisplacementMoments const* moments, double const* without_medium,
                                  CentroidSum<double>* hits) {
  PlaceRule const& rule = model.places;
  double all = 0;
  for (int i = 0; i < rule.count; ++i) all += rule.weights[i] * without_medium[i];
  for (int frame = 0; frame < frame_count; ++frame) {
    std::int64_t const count = hits[frame].count;
    hits[frame] = {};
    hits[frame].count = count;
  }
  for (int i = 0; i < rule.count; ++i) {
    double const share = rule.weights[i] * without_medium[i] / all;
    add_place(hits[0], hits[1], model.image.half_size_px() * rule.places[i], plan.expected_weight * share, moments[i],
              origin);
  }
}

/// Number of straight rays that a dot's cone average of Eq. 9 takes: the points of the rule at every place of the
/// source where there is one, else the dot's own rays.
GLADSTONE_HD inline std::uint64_t theory_rays(LightModel const& model, std::uint64_t rays) {
  std::uint64_t const points =
      static_cast<std::uint64_t>(model.cone.count) * static_cast<std::uint64_t>(model.places.count);
  return points > 0 ? points : rays;
}
/// Adds the i-th of them.
template <class Medium>
GLADSTONE_HD void add_straight_ray(LightModel const& model, TheoryModel const& theory, SceneView<double> const& view,
                                   Medium const& medium, std::uint64_t dot, std::uint64_t i, ConeSum& sum) {
  if (model.cone.count == 0) {
    sum.add(theory, view, medium, dot, i);
    return;
  }
  int const place = static_cast<int>(i) / model.cone.count;
  ConePoint const at = model.cone.points[static_cast<int>(i) % model.cone.count];
  Vec2d const from = view.sources.centre[dot] + model.offset(model.places.places[place]);
  Vec2d const pupil = (at.radius * model.image.stop_radius) * model.cone.directions[at.direction];
  Vec3d const start{from.x, from.y, view.sources.plane_z};
  Ray<double> const ray{start, normalized(Vec3d{pupil.x - from.x, pupil.y - from.y, view.bundle.lens_z - start.z})};
  double const cosine2 = ray.direction.z * ray.direction.z;
  sum.add(theory, medium, ray, model.places.weights[place] * at.weight * cosine2 * cosine2);
}

/// Displacement of a ray of a controlled dot: from hit to hit, so that what the medium leaves alone is exactly zero;
/// from the geometric image of its place where it passes in the flow alone [px].
GLADSTONE_HD inline Vec2d flow_displacement(LightModel const& model, RayRecord<double> const& ray) {
  if (ray.flow_weight == 0) return {};
  return ray.reference_weight != 0 ? ray.flow - ray.reference : ray.flow - model.image.half_size_px() * ray.place;
}

/// Light that the i-th point of the source leaves in the reference frame. @param source which of the model's rules
GLADSTONE_HD inline Deposit reference_light(LightModel const& model, CubatureView const& source, DotPlan const& plan,
                                            int i) {
  return {plan.origin + model.image.half_size_px() * source.points[i], plan.expected_weight * source.weights[i]};
}

/// Light that the fit expects in the flow from the i-th point of the source through the k-th point of the stop.
GLADSTONE_HD inline Deposit expected_light(LightModel const& model, DotPlan const& plan, FlowFit const& fit,
                                           CubatureView const& pupil, int i, int k) {
  Vec2d const place = model.source.points[i];
  Vec2d const through = fit.pupil_of(model.image.stop_radius * pupil.points[k], place);
  Deposit light = reference_light(model, model.source, plan, i);
  light.at += fit.displacement(place, through);
  light.weight *= fit.area_ratio() * pupil.weights[k];
  return light;
}

/// Where a ray's light lands in the flow, and, negative, where the fit has put it already; both nothing where they
/// agree.
struct Remainder {
  Deposit landed, expected;
};
GLADSTONE_HD inline Remainder remaining_light(LightModel const& model, DotPlan const& plan, FlowFit const& fit,
                                              RayRecord<double> const& ray) {
  Vec2d const p = plan.origin + model.image.half_size_px() * ray.place;
  Vec2d const arrival = fit.arrival(ray.pupil, ray.place);
  double const expected =
      ray.weight * (model.image.has_stop ? model.image.stop.transmission(arrival.x, arrival.y) : 1.0);
  Vec2d const moved = fit.displacement(ray.place, ray.pupil), hit = flow_displacement(model, ray);
  if (moved == hit && expected == ray.flow_weight) return {};
  return {{p + hit, ray.flow_weight}, {p + moved, -expected}};
}

}  // namespace gladstone
