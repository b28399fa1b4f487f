#pragma once

#include <cmath>
#include <type_traits>

#include "render/base/units.h"
#include "render/rays/aimed_sources.h"
#include "render/scene/camera.h"

// Device code does not unroll loops over rays, since each loop body contains a whole camera and a medium.
#if defined(__CUDA_ARCH__)
#define GLADSTONE_RAY_BY_RAY _Pragma("unroll 1")
#define GLADSTONE_SHARED_BY_KERNELS __noinline__
#else
#define GLADSTONE_RAY_BY_RAY
#define GLADSTONE_SHARED_BY_KERNELS
#endif

namespace gladstone::inline rays {

/// Tolerance of the edge of the filled disc, as a fraction of the stop's radius. The relative error of a source's light
/// is at most twice that: half a grey level at 12 bits.
inline constexpr double fill_tolerance = 6e-5;

/// Stop of a camera and the optics in front of it, as required to aim rays at it: a non-owning view.
struct StopView {
  CameraView<double> camera;  ///< camera; the edge of its stop must be sharp
  int stop = 0;               ///< index of the stop among the camera's elements
  double radius = 0;          ///< radius of the stop [m]
  Pose<double> pose;          ///< pose of the camera
  double front = 0;           ///< position of the first surface along the camera's z [m]
  double window_shift = 0;    ///< apparent shift of objects, see ParaxialCamera::window_shift [m]
  RayTransfer to_stop;        ///< ray transfer from the first surface to the stop

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

/// Maps the unit disc to the entrance pupil on the aim plane: centre + sum over m = 1, 2, 3 of a_m Re z^m + b_m Im z^m
/// with z = x + i y [m]. The first order is an ellipse; the higher ones are its deformation by pupil aberrations. Being
/// harmonic, the polynomials are determined inside the disc by their values on the edge.
struct AimMap {
  static constexpr int orders = 3;

  Vec2d centre{};
  Vec2d a[orders]{}, b[orders]{};

  GLADSTONE_HD Vec2d at(Vec2d u) const {
    Vec2d place = centre, power = u;
    for (int m = 0; m < orders; ++m) {
      place += power.x * a[m] + power.y * b[m];
      power = {power.x * u.x - power.y * u.y, power.x * u.y + power.y * u.x};
    }
    return place;
  }
  /// Returns the Jacobian determinant of the map at a point of the disc; negative if the map mirrors [m^2].
  GLADSTONE_HD double stretch(Vec2d u) const {
    Vec2d by_x{}, by_y{}, power{1, 0};
    for (int m = 0; m < orders; ++m) {
      double const times = m + 1;
      by_x += times * (power.x * a[m] + power.y * b[m]);
      by_y += times * (power.x * b[m] - power.y * a[m]);
      power = {power.x * u.x - power.y * u.y, power.x * u.y + power.y * u.x};
    }
    return by_x.x * by_y.y - by_x.y * by_y.x;
  }
};

/// Rays of one point that fill the stop exactly.
struct FilledStop {
  AimMap map;           ///< maps the unit disc to the aim plane
  Vec2d low{}, high{};  ///< bounding box of the edge rays on the sensor [px]
  double spread2 = 0;   ///< variance along an axis of the hits, for rays that fill a disc with this edge [px^2]
};

namespace detail {

/// Intersects a ray with the stop, through an optional medium and ignoring vignetting.
/// @param place  receives the intersection in the stop's frame [m]
/// @return false if the ray is lost before the stop
template <class Medium>
GLADSTONE_HD bool meets_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                             Ray<double> ray, Vec2d& place) {
  CameraView<double> const& camera = view.camera;
  if (!carry_ignoring_vignetting(camera, 0, camera.before_medium, ray)) return false;
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    Ray<double> const start[1] = {ray};
    MediumPassage<double> way[1];
    trace_medium(medium, options, start, way);
    if (way[0].status != RayStatus::alive) return false;
    ray = outgoing_ray(ray, way[0]);
  }
  if (!carry_ignoring_vignetting(camera, camera.before_medium, view.stop, ray)) return false;
  return camera.elements[view.stop].visit([&](auto const& held) { return held.meet(ray, place); });
}

}  // namespace detail

/// Returns the ray from a point to a position on the aim plane.
GLADSTONE_HD inline Ray<double> ray_to_aim(CameraView<double> const& camera, Vec3d point, Vec2d aim) {
  return {point, normalized(camera.aim_plane.point_to_outer({aim.x, aim.y, 0}) - point)};
}

/// Returns the paraxial entrance pupil as seen from a point, without medium.
GLADSTONE_HD inline AimMap paraxial_aim(StopView const& view, Vec3d point) {
  Vec3d const q = view.pose.point_to_local(point);
  double const distance = view.front - q.z - view.window_shift;
  double const per_slope = view.to_stop.a * distance + view.to_stop.b;  // position in the stop per unit slope of a ray
                                                                        // [m]
  double const height = view.to_stop.b / per_slope, radius = view.radius * distance / per_slope;
  AimMap map;
  map.centre = {height * q.x, height * q.y};
  map.a[0] = {radius, 0};
  map.b[0] = {0, radius};
  return map;
}

inline constexpr int rim_rays = 8;

/// Finds the aim points of eight rays that meet the edge of the stop at equal angles, the first on its x axis, and fits
/// the map through them.
/// Uses a quasi-Newton iteration with the best-fitting ellipse in place of derivatives, so that each iteration reduces
/// the residual by about the ratio of pupil aberration to pupil size.
/// @param map  start value; receives the result
/// @return false if a ray is lost or the iteration does not converge
template <class Medium>
GLADSTONE_HD bool fit_to_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                              Vec3d point, AimMap& map) {
  constexpr int most_turns = 16;
  constexpr double settled = 1e-7;  // tolerance relative to the pupil radius; the final residual is far smaller
  Vec2d aim[rim_rays], miss[rim_rays];
  for (int k = 0; k < rim_rays; ++k) aim[k] = map.at(point_on_circle(1.0, static_cast<double>(k) / rim_rays));
  double change = 1;
  GLADSTONE_RAY_BY_RAY
  for (int turn = 0; !(change <= settled); ++turn) {
    if (turn == most_turns) return false;
    Vec2d a{}, b{}, by_a{}, by_b{};  // best-fitting ellipse on the aim plane, and its axes mapped to the stop
    GLADSTONE_RAY_BY_RAY
    for (int k = 0; k < rim_rays; ++k) {
      Vec2d met;
      if (!detail::meets_stop(view, medium, options, ray_to_aim(view.camera, point, aim[k]), met)) return false;
      Vec2d const here = point_on_circle(1.0, static_cast<double>(k) / rim_rays);
      a += (2.0 / rim_rays) * here.x * aim[k];
      b += (2.0 / rim_rays) * here.y * aim[k];
      by_a += (2.0 / rim_rays) * here.x * met;
      by_b += (2.0 / rim_rays) * here.y * met;
      miss[k] = met - view.radius * here;
    }
    double const area = by_a.x * by_b.y - by_a.y * by_b.x;
    if (!(area > 1e-6 * view.radius * view.radius || area < -1e-6 * view.radius * view.radius)) return false;
    change = 0;
    for (int k = 0; k < rim_rays; ++k) {
      Vec2d const by = ((miss[k].x * by_b.y - miss[k].y * by_b.x) / area) * a +
                       ((by_a.x * miss[k].y - by_a.y * miss[k].x) / area) * b;
      aim[k] -= by;
      double const moved = length(by) / length(a);
      if (!(moved <= change)) change = moved;
    }
  }
  map = {};
  for (int k = 0; k < rim_rays; ++k) {
    map.centre += (1.0 / rim_rays) * aim[k];
    for (int m = 0; m < AimMap::orders; ++m) {
      Vec2d const here = point_on_circle(2.0 / rim_rays, static_cast<double>(k * (m + 1)) / rim_rays);
      map.a[m] += here.x * aim[k];
      map.b[m] += here.y * aim[k];
    }
  }
  return true;
}

/// Finds the map of rays that fill the stop exactly, with or without medium. As a check, eight rays just inside the
/// edge must pass the camera and eight just outside must be vignetted.
/// @param filled  start value of the map; receives the result
/// @return false if the check fails: in media that vary strongly within the light cone, and where more than one
/// aperture limits the light
template <class Medium>
GLADSTONE_HD bool fill_stop(StopView const& view, Medium const& medium, TracingOptions<double> const& options,
                            Vec3d point, FilledStop& filled) {
  if (!fit_to_stop(view, medium, options, point, filled.map)) return false;
  Vec2d first{}, sum{};  // positions of edge rays on the sensor, relative to the first [px]
  double squares = 0;
  GLADSTONE_RAY_BY_RAY
  for (int k = 0; k < 2 * rim_rays; ++k) {
    bool const within = k % 2 == 0;
    int const pair = k / 2;
    Vec2d const at = point_on_circle(within ? 1 - fill_tolerance : 1 + fill_tolerance, (pair + 0.5) / rim_rays);
    RayHit<double> const hit =
        trace_ray(view.camera, medium, options, ray_to_aim(view.camera, point, filled.map.at(at)), 1.0);
    if (within ? !reaches_sensor_plane(hit.status) : hit.status != RayStatus::vignetted) return false;
    if (!within) continue;
    Vec2d const p = hit.pixel;
    if (k == 0) filled.low = filled.high = first = p;
    sum += p - first;
    squares += dot(p - first, p - first);
    filled.low = {p.x < filled.low.x ? p.x : filled.low.x, p.y < filled.low.y ? p.y : filled.low.y};
    filled.high = {p.x > filled.high.x ? p.x : filled.high.x, p.y > filled.high.y ? p.y : filled.high.y};
  }
  filled.spread2 = 0.25 * (squares / rim_rays - dot(sum, sum) / (rim_rays * rim_rays));
  // Shrink the map by 1e-7, so that rounding vignettes no ray.
  double inside = 1;
  for (int m = 0; m < AimMap::orders; ++m) {
    inside *= 1 - 1e-7;
    filled.map.a[m] *= inside;
    filled.map.b[m] *= inside;
  }
  return true;
}

/// Returns the whole-pixel position to which a source's sums are relative [px].
GLADSTONE_HD inline Vec2d sum_origin(FilledStop const& filled) {
  using std::floor;
  Vec2d const middle = 0.5 * (filled.low + filled.high);
  return {floor(middle.x + 0.5), floor(middle.y + 0.5)};
}

/// Returns the ray of source i to a position on the aim plane.
/// @param area  area of the aim plane that the ray represents, times the number of rays [m^2]
template <class Sources>
GLADSTONE_HD AimedRay<double> ray_to_plane(Sources const& sources, Pose<double> const& plane, Vec2d place, double area,
                                           std::uint64_t i) {
  AimedBundle<double> const there{plane.point_to_outer({place.x, place.y, 0}), {}, {}, area * plane.z, {}};
  return ray_to(sources, there, i, {}, {});
}

/// Returns the ray of source i to the image of a point of the unit disc under a map to the aim plane.
template <class Sources>
GLADSTONE_HD AimedRay<double> ray_to(Sources const& sources, Pose<double> const& plane, AimMap const& map,
                                     std::uint64_t i, Vec2d at) {
  return ray_to_plane(sources, plane, map.at(at), pi * map.stretch(at), i);
}

}  // namespace gladstone::inline rays
