#pragma once

#include <cmath>
#include <type_traits>

#include "render/base/units.h"
#include "render/rays/aimed_sources.h"
#include "render/scene/camera.h"

namespace gladstone {

/// How far the rim that rays are sent to may lie from the stop's, as a share of its radius: twice that is the most that
/// the light of a source is wrong by, which is half a grey level of 12 bits.
inline constexpr double filled_to = 6e-5;

/// A camera's stop as rays are sent to it: a view that owns nothing.
struct StopView {
  CameraView<double> camera;  ///< its stop with a sharp rim
  int stop = 0;               ///< of the elements
  double radius = 0;          ///< of the stop [m]
  Pose<double> pose;          ///< of the camera
  double front = 0;           ///< first surface, along the camera's z [m]
  double window_shift = 0;    ///< as ParaxialCamera's [m]
  RayTransfer to_stop;        ///< from the first surface

  StopView() = default;
  explicit StopView(Camera const& of)
      : camera(of.view()),
        stop(of.stop),
        radius(of.stop_radius),
        pose(of.pose),
        front(of.paraxial.front),
        window_shift(of.paraxial.window_shift),
        to_stop(of.paraxial.to_stop) {}
};

/// An ellipse on the aim plane, in its frame: centre + a cos + b sin, a towards the stop's x and b towards its y [m].
struct AimEllipse {
  Vec2d centre{}, a{}, b{};

  GLADSTONE_HD Vec2d at(Vec2d unit_disc) const { return centre + unit_disc.x * a + unit_disc.y * b; }
};

/// Where rays of a point go to fill the stop.
struct FilledStop {
  AimEllipse ellipse;
  WorldAimDisc disc;    ///< the same in the world, a hair's breadth inside
  Vec2d low{}, high{};  ///< between which the rays of the rim end on the sensor [px]
};

namespace detail {

/// Takes a ray through an element, past its rim or not. @return false where it is lost
GLADSTONE_HD inline bool goes_on(CameraElement<double> const& element, Ray<double>& ray) {
  RayAccount<double> account;
  RayStatus const status = element.visit([&](auto const& held) { return held.interact(ray, account); });
  return status == RayStatus::alive || status == RayStatus::vignetted;
}

/// Where a ray meets the stop through a medium or without, in the stop's frame [m]. @return false: it is lost before
template <class Medium>
GLADSTONE_HD bool meets_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                             Ray<double> ray, Vec2d& place) {
  CameraView<double> const& camera = view.camera;
  for (int i = 0; i < camera.before_medium; ++i) {
    if (!goes_on(camera.elements[i], ray)) return false;
  }
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    Ray<double> const start[1] = {ray};
    MediumPassage<double> way[1];
    trace_medium(medium, options, start, way);
    if (way[0].status != RayStatus::alive) return false;
    ray = outgoing_ray(ray, way[0]);
  }
  for (int i = camera.before_medium; i < view.stop; ++i) {
    if (!goes_on(camera.elements[i], ray)) return false;
  }
  return camera.elements[view.stop].visit([&](auto const& held) { return held.meet(ray, place); });
}

}  // namespace detail

/// The ray from a point to a place of the aim plane.
GLADSTONE_HD inline Ray<double> ray_to_aim(CameraView<double> const& camera, Vec3d point, Vec2d aim) {
  return {point, normalized(camera.aim_plane.point_outwards({aim.x, aim.y, 0}) - point)};
}

/// The ellipse that a point sees the stop as in paraxial light, without a medium.
GLADSTONE_HD inline AimEllipse paraxial_ellipse(StopView const& view, Vec3d point) {
  Vec3d const q = view.pose.point_inwards(point);
  double const distance = view.front - q.z - view.window_shift;
  double const per_slope = view.to_stop.a * distance + view.to_stop.b;  // in the stop, over a ray's slope [m]
  double const height = view.to_stop.b / per_slope, radius = view.radius * distance / per_slope;
  return {{height * q.x, height * q.y}, {radius, 0}, {0, radius}};
}

/// Moves and stretches an ellipse until four rays of its rim, at the ends of a and b, meet the stop's rim at the ends
/// of its x and y: secants over the ellipse stand for derivatives, so that a turn leaves of what is wrong the share
/// that the pupil's aberration is of the pupil. @return false: there are no such rays
template <class Medium>
GLADSTONE_HD bool fit_to_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                              Vec3d point, AimEllipse& ellipse) {
  constexpr int most_turns = 16;
  constexpr double settled = 1e-9;  // of the radius; what the last turn leaves is less by far
  for (int turn = 0; turn < most_turns; ++turn) {
    Vec2d met[4];
    for (int k = 0; k < 4; ++k) {
      double const sign = k % 2 == 0 ? 1 : -1;
      Vec2d const aim = ellipse.at(k < 2 ? Vec2d{sign, 0} : Vec2d{0, sign});
      if (!detail::meets_stop(view, medium, options, ray_to_aim(view.camera, point, aim), met[k])) return false;
    }
    Vec2d const by_a = 0.5 * (met[0] - met[1]), by_b = 0.5 * (met[2] - met[3]);
    Vec2d const middle = 0.25 * (met[0] + met[1] + met[2] + met[3]);
    double const area = by_a.x * by_b.y - by_a.y * by_b.x;
    if (!(std::abs(area) > 1e-6 * view.radius * view.radius)) return false;
    auto const aimed = [&](Vec2d in_stop) {
      return ((in_stop.x * by_b.y - in_stop.y * by_b.x) / area) * ellipse.a +
             ((by_a.x * in_stop.y - by_a.y * in_stop.x) / area) * ellipse.b;
    };
    AimEllipse const next{ellipse.centre - aimed(middle), aimed({view.radius, 0}), aimed({0, view.radius})};
    double const change =
        length(next.centre - ellipse.centre) + length(next.a - ellipse.a) + length(next.b - ellipse.b);
    ellipse = next;
    if (change <= settled * length(ellipse.a)) return true;
  }
  return false;
}

/// Where rays of a point are to be sent so that they fill the stop and nothing else, through a medium or without: the
/// ellipse that the stop is seen as. Eight rays just within its rim must pass the camera, and eight just beyond it must
/// not.
/// @param filled begins with the ellipse to start from
/// @return false where rays do otherwise, in media that change much within the cone and behind lenses whose pupil is no
/// ellipse
template <class Medium>
GLADSTONE_HD bool fill_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                            Vec3d point, FilledStop& filled) {
  if (!fit_to_stop(view, medium, options, point, filled.ellipse)) return false;
  constexpr int rays = 8;
  for (int k = 0; k < rays; ++k) {
    Vec2d const at = point_of_circle(1.0, (k + 0.5) / rays);
    auto const trace = [&](double radius) {
      return trace_ray(view.camera, medium, options, ray_to_aim(view.camera, point, filled.ellipse.at(radius * at)),
                       1.0);
    };
    RayHit<double> const within = trace(1 - filled_to);
    if (!reaches_sensor_plane(within.status) || trace(1 + filled_to).status != RayStatus::vignetted) return false;
    Vec2d const p = within.pixel;
    filled.low = k == 0 ? p : Vec2d{p.x < filled.low.x ? p.x : filled.low.x, p.y < filled.low.y ? p.y : filled.low.y};
    filled.high =
        k == 0 ? p : Vec2d{p.x > filled.high.x ? p.x : filled.high.x, p.y > filled.high.y ? p.y : filled.high.y};
  }
  // so that rounding clips no ray
  constexpr double inside = 1 - 1e-7;
  Pose<double> const& plane = view.camera.aim_plane;
  auto const along = [&](Vec2d v) { return inside * plane.direction_outwards({v.x, v.y, 0}); };
  filled.disc = {plane.point_outwards({filled.ellipse.centre.x, filled.ellipse.centre.y, 0}), along(filled.ellipse.a),
                 along(filled.ellipse.b)};
  return true;
}

/// The whole pixel that a source's sums count from [px].
GLADSTONE_HD inline Vec2d origin_of(FilledStop const& filled) {
  return {std::round(0.5 * (filled.low.x + filled.high.x)), std::round(0.5 * (filled.low.y + filled.high.y))};
}

/// Rays that fill a stop.
GLADSTONE_HD inline AimedBundle<double> bundle_of(WorldAimDisc const& disc, BundleView<double> const& choice) {
  return {disc.centre, disc.a, disc.b, pi * cross(disc.a, disc.b), choice};
}

}  // namespace gladstone
