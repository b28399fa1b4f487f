#pragma once

#include <cmath>
#include <optional>
#include <type_traits>

#include "render/rays/source_tracer.h"

namespace gladstone {

/// How far the rim that rays are sent to may lie from the stop's, as a share of its radius: twice that is the most that
/// the light of a source is wrong by, which is half a grey level of 12 bits.
inline constexpr double filled_to = 6e-5;

/// Where rays of a point are to be sent so that they fill the stop and nothing else, through a medium or without: the
/// ellipse that the stop is seen as, moved and stretched against what the medium does to four rays of its rim. Eight
/// rays just within its rim must pass the stop, and eight just beyond it must not; nothing where they do otherwise, in
/// media that change much within the cone and behind lenses whose pupil is no ellipse.
/// @param view with a sharp stop
template <class Medium>
std::optional<WorldAimDisc> filled_stop(RaysLaunch const& launch, CameraView<double> const& view, Medium const& medium,
                                        Vec3d point) {
  auto const wide = launch.sight(point);
  if (!wide) return std::nullopt;
  double const margin = Camera::sight_margin();
  WorldAimDisc disc{wide->centre, wide->a / margin, wide->b / margin};
  auto const to = [point](Vec3d aim) { return Ray<double>{point, normalized(aim - point)}; };
  auto const trace = [&](auto const& through, Vec3d aim) {
    return trace_ray(view, through, launch.tracing, to(aim), 1.0);
  };
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    // by how much the medium moves a ray on the aim plane
    auto const moved = [&](Vec3d aim, Vec3d& by) {
      RayHit<double> const straight = trace(NoMedium<double>{}, aim), bent = trace(medium, aim);
      Vec2d const on_plane = bent.at_lens - straight.at_lens;
      by = launch.camera.aim_plane.direction_outwards({on_plane.x, on_plane.y, 0});
      return std::max(straight.status, bent.status) <= RayStatus::vignetted;
    };
    WorldAimDisc const straight = disc;
    Vec3d more_a, less_a, more_b, less_b;
    bool const known = moved(straight.centre + straight.a, more_a) && moved(straight.centre - straight.a, less_a) &&
                       moved(straight.centre + straight.b, more_b) && moved(straight.centre - straight.b, less_b);
    if (!known) return std::nullopt;
    // the map of aims to places on the plane, to first order, inverted
    Pose<double> const& plane = launch.camera.aim_plane;
    Vec3d const by_a = straight.a + 0.5 * (more_a - less_a), by_b = straight.b + 0.5 * (more_b - less_b);
    Vec2d const a{dot(by_a, plane.x), dot(by_a, plane.y)}, b{dot(by_b, plane.x), dot(by_b, plane.y)};
    double const area = a.x * b.y - a.y * b.x;
    if (area == 0) return std::nullopt;
    auto const aimed = [&](Vec3d wanted) {
      Vec2d const w{dot(wanted, plane.x), dot(wanted, plane.y)};
      return ((w.x * b.y - w.y * b.x) / area) * straight.a + ((a.x * w.y - a.y * w.x) / area) * straight.b;
    };
    disc = {straight.centre - aimed(0.25 * (more_a + less_a + more_b + less_b)), aimed(straight.a), aimed(straight.b)};
  }
  constexpr int rays = 8;
  for (int k = 0; k < rays; ++k) {
    Vec2d const at = point_of_circle(1.0, (k + 0.5) / rays);
    Vec3d const rim = at.x * disc.a + at.y * disc.b;
    bool const within = reaches_sensor_plane(trace(medium, disc.centre + (1 - filled_to) * rim).status);
    bool const beyond = trace(medium, disc.centre + (1 + filled_to) * rim).status == RayStatus::vignetted;
    if (!within || !beyond) return std::nullopt;
  }
  // a hair's breadth inside, so that rounding clips no ray
  constexpr double inside = 1 - 1e-7;
  return WorldAimDisc{disc.centre, inside * disc.a, inside * disc.b};
}

}  // namespace gladstone
