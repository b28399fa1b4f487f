#include "render/rays/rays_launch.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/scene/scene.h"

namespace gladstone::inline rays {
namespace {

/// Returns the smaller semi-axis of the ellipse [m].
double smaller_semi_axis(WorldApparentPupil const& disc) {
  // Semi-axes are the singular values of (a b), computed from their sum of squares and their product.
  double const squares = dot(disc.a, disc.a) + dot(disc.b, disc.b), area = length(cross(disc.a, disc.b));
  return std::sqrt(0.5 * (squares - std::sqrt(std::max(0.0, squares * squares - 4 * area * area))));
}

/// Returns how far the entrance pupil, as seen from a point, moves when the point moves away from the source's middle.
/// The derivatives are finite differences between the corners of a hexagon of circumradius `radius` around the middle;
/// nullopt if no chief ray passes from one of the corners.
std::optional<AimShift> difference_shift(Camera const& camera, WorldApparentPupil const& disc, Vec3d middle,
                                         double reach, double radius) {
  constexpr int corners = 6;
  Vec2d towards[corners];
  WorldApparentPupil seen[corners];
  AimShift shift;
  for (int k = 0; k < corners; ++k) {
    towards[k] = point_on_circle(1.0, static_cast<double>(k) / corners);
    auto const there = camera.apparent_pupil(middle + radius * Vec3d{towards[k].x, towards[k].y, 0});
    if (!there) return std::nullopt;
    seen[k] = *there;
    shift.by_x += (2 * towards[k].x / (corners * radius)) * there->centre;
    shift.by_y += (2 * towards[k].y / (corners * radius)) * there->centre;
  }
  // The remaining shift grows with the square of the offset, the change of size and shape in proportion to it. A
  // quadratic form on the circle is at most 5/3 of its largest value at the corners, a linear form at most 1.16 times.
  constexpr double between_corners = 5.0 / 3;
  double const larger = reach / radius;
  for (int k = 0; k < corners; ++k) {
    Vec3d const linear = radius * (towards[k].x * shift.by_x + towards[k].y * shift.by_y);
    double const curved = length(seen[k].centre - disc.centre - linear);
    double const reshaped = std::hypot(length(seen[k].a - disc.a), length(seen[k].b - disc.b));
    shift.residual = std::max(shift.residual, between_corners * larger * (larger * curved + reshaped));
  }
  return shift;
}

}  // namespace

RaysLaunch::RaysLaunch(Scene const& scene, RenderPlan const& plan, SpotView const& shown, StopRim rim, RayOrder order)
    : camera(scene.camera),
      tracing{plan.step, scene.setup.medium.ambient_refractivity(), scene.setup.medium.integrator,
              scene.setup.medium.faces},
      spot(shown),
      z_b(scene.setup.z_b()),
      ordered(order == RayOrder::neighbours && scene.medium.grid.nodes[0] > 1) {
  choice.seed = plan.seed;
  choice.sampling = scene.setup.render.sampling;
  set_rays(plan.rays);
  if (rim == StopRim::smooth && !camera.chief_rays_only()) {
    camera.smooth_stop(Scene::stop_edge(static_cast<double>(rays)));
  }
  // Light of a pixel on the axis: the area that it sees times the cosine and the solid angle of its light cone.
  auto const seen = camera.unproject(camera.sensor.axis_pixel(), scene.target_plane());
  if (!seen)
    throw DataError(ErrorCode::invalid_value, KeyPath{"lens"},
                    "the axis of the camera does not meet the plane of the dots in front of it (the camera looks away "
                    "from it or parallel to it); correct camera.pose or geometry");
  point_area = 1 / std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x);
  Vec3d const from = scene.target_plane().point_to_outer({seen->place.x, seen->place.y, 0});
  double const cosine = std::abs(seen->chief.direction.z);
  if (camera.chief_rays_only()) {
    Vec3d const way = camera.aim_plane.origin - from;
    light_unit = point_area * cosine * std::abs(dot(seen->chief.direction, camera.aim_plane.z)) / dot(way, way);
  } else {
    double const slope = camera.paraxial.marginal_slope(camera.paraxial.front - camera.pose.point_to_local(from).z);
    light_unit = point_area * cosine * pi * slope * slope;
  }
}

RaysLaunch RaysLaunch::with_rays(std::uint64_t number) const {
  RaysLaunch other = *this;
  other.set_rays(number);
  if (soft()) other.camera.smooth_stop(Scene::stop_edge(static_cast<double>(number)));
  return other;
}

void RaysLaunch::set_rays(std::uint64_t number) {
  rays = number;
  choice.scrambling_bits = scrambling_bits(rays);
  choice.ordered_points = ordered ? complete_points(rays, choice.scrambling_bits) : 0;
}

bool RaysLaunch::soft() const {
  if (camera.chief_rays_only()) return false;
  return camera.elements[static_cast<std::size_t>(camera.stop)].visit([](auto const& held) {
    if constexpr (std::is_same_v<std::decay_t<decltype(held)>, PosedStop<double>>) return held.edge > 0;
    return false;
  });
}

AimShift RaysLaunch::aim_shift(WorldApparentPupil const& disc, Vec3d middle, double reach) const {
  AimShift const none{{}, {}, reach};
  if (camera.chief_rays_only() || reach <= smaller_semi_axis(disc)) return none;
  // At the edge of the field of view, chief rays may pass only from points closer to the middle.
  for (double const share : {1.0, 0.5, 0.25, 0.125}) {
    auto const shift = difference_shift(camera, disc, middle, reach, share * reach);
    if (shift) return shift->residual < reach ? *shift : none;
  }
  return none;
}

AimedBundle<double> RaysLaunch::bundle(WorldApparentPupil const& disc, AimShift const& shift, double margin) const {
  if (camera.chief_rays_only()) return {disc.centre, {}, {}, camera.aim_plane.z, choice};
  double const rim = soft() ? std::sqrt(1 + Scene::stop_edge(static_cast<double>(rays)) / 2) : 1;
  double const wider = rim + (margin + shift.residual) / smaller_semi_axis(disc);
  AimedBundle<double> bundle{disc.centre, wider * disc.a, wider * disc.b, {}, choice, shift.by_x, shift.by_y};
  bundle.across = pi * cross(bundle.a, bundle.b);
  return bundle;
}

double RaysLaunch::first_margin(WorldApparentPupil const& disc, double shift) const {
  return shift > 0 ? 2 * shift + 0.01 * smaller_semi_axis(disc) : 0;
}

std::optional<double> RaysLaunch::wider_margin(double margin, double shift) const {
  if (camera.chief_rays_only() || !(shift > margin)) return std::nullopt;
  double const wider = 1.02 * shift;
  check_deflection_limit(wider, z_b);
  return wider;
}

}  // namespace gladstone::inline rays
