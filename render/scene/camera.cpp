#include "render/scene/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "render/optics/trace_back.h"

namespace gladstone::inline scene {
namespace {

constexpr int rim_points = 8;  // points on the edge of the stop by which the entrance pupil is found

/// Returns true for lenslets. They form many small images of the stop; the image position of a point is that of the
/// main lens.
bool divides_light(CameraElement<double> const& element) {
  return element.visit([](auto const& held) {
    return requires { held.divides_light; };
  });
}

}  // namespace

double ParaxialCamera::chief_slope(double distance) const {
  return -to_stop.a / (to_stop.a * (distance - window_shift) + to_stop.b);
}

double ParaxialCamera::marginal_slope(double distance) const {
  return std::abs(stop_radius / (to_stop.a * (distance - window_shift) + to_stop.b));
}

double ParaxialCamera::image_slope(double distance) const {
  double const u = marginal_slope(distance);
  return std::abs(whole.c * (distance - window_shift) * u + whole.d * u);
}

void Camera::smooth_stop(double edge) {
  auto& element = elements[static_cast<std::size_t>(stop)];
  element = element.visit([edge](auto held) -> CameraElement<double> {
    if constexpr (std::is_same_v<decltype(held), PosedStop<double>>) held.edge = edge;
    return held;
  });
}

Ray<double> Camera::towards(Vec3d point, Vec2d aim) const {
  return {point, normalized(aim_plane.point_to_outer({aim.x, aim.y, 0}) - point)};
}

std::optional<Vec2d> Camera::in_stop(Vec3d point, Vec2d aim) const {
  Ray<double> ray = towards(point, aim);
  if (!carry_ignoring_vignetting(view(), 0, stop, ray)) return std::nullopt;
  Vec2d place;
  bool const met =
      elements[static_cast<std::size_t>(stop)].visit([&](auto const& held) { return held.meet(ray, place); });
  return met ? std::optional(place) : std::nullopt;
}

std::optional<Camera::Sight> Camera::sight(Vec3d point, Vec2d aim) const {
  Ray<double> ray = towards(point, aim);
  Sight seen;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (divides_light(elements[i])) continue;
    bool const met = static_cast<int>(i) != stop ||
                     elements[i].visit([&](auto const& held) { return held.meet(ray, seen.in_stop); });
    if (!met || !trace_ignoring_vignetting(elements[i], ray)) return std::nullopt;
  }
  Vec2d place;
  if (!sensor.meet(ray, place)) return std::nullopt;
  seen.pixel = sensor.to_pixel(place.x, place.y);
  return seen;
}

double Camera::in_stop_unit() const { return stop_radius > 0 ? stop_radius : 1e4 * aim_step; }

StopMapping Camera::stop_sight(Vec3d point) const {
  auto const back = [this](Vec2d slope) -> std::optional<Ray<double>> {
    auto const line = trace_back_from_stop(elements, stop, slope);
    return line ? std::optional(aim_plane.inwards(*line)) : std::nullopt;
  };
  return {[this, point](Vec2d aim) { return in_stop(point, aim); }, in_stop_unit(), aim_step,
          RayOrigin::point(aim_plane.point_to_local(point)), back};
}

Vec2d Camera::paraxial_aim(Vec3d point) const {
  Vec3d const q = pose.point_to_local(point);
  double const distance = paraxial.front - q.z;
  double const scale = 1 + paraxial.chief_slope(distance) * (distance - paraxial.window_shift);
  return {scale * q.x, scale * q.y};
}

std::optional<Vec2d> Camera::chief_aim(Vec3d point) const {
  return find_chief_aim(stop_sight(point), paraxial_aim(point));
}

std::optional<Vec2d> Camera::project(Vec3d point) const {
  auto const aim = chief_aim(point);
  if (!aim) return std::nullopt;
  auto const seen = sight(point, *aim);
  return seen ? std::optional(seen->pixel) : std::nullopt;
}

double Camera::place_step(Pose<double> const& plane) const {
  // About a pixel: small compared with the length scale of distortion, large compared with rounding errors.
  double const focal = 1 / std::max(std::abs(paraxial.whole.c), 1e-3);
  return sensor.pitch * std::max(1.0, length(plane.origin - pose.origin) / focal);
}

bool Camera::differentiate(Vec2d aim, Pose<double> const& plane, ImagedPoint& seen) const {
  double const h = place_step(plane);
  auto const point = [&](double dx, double dy) {
    return plane.point_to_outer({seen.place.x + dx, seen.place.y + dy, 0});
  };
  // Derivatives of pixel and stop position with respect to object point and aim; the chief ray remains at its stop
  // position.
  Sight by[4];
  for (int k = 0; k < 4; ++k) {
    Vec2d const move = (k < 2 ? h : aim_step) * Vec2d{k % 2 == 0 ? 1.0 : 0.0, k % 2 == 0 ? 0.0 : 1.0};
    auto const more = k < 2 ? sight(point(move.x, move.y), aim) : sight(point(0, 0), aim + move);
    auto const less = k < 2 ? sight(point(-move.x, -move.y), aim) : sight(point(0, 0), aim - move);
    if (!more || !less) return false;
    double const apart = 2 * (k < 2 ? h : aim_step);
    by[k] = {(more->in_stop - less->in_stop) / apart, (more->pixel - less->pixel) / apart};
  }
  Eigen::Matrix2d in_stop_by_aim;
  in_stop_by_aim << by[2].in_stop.x, by[3].in_stop.x, by[2].in_stop.y, by[3].in_stop.y;
  for (int k = 0; k < 2; ++k) {
    Eigen::Vector2d const aim_moves =
        in_stop_by_aim.partialPivLu().solve(Eigen::Vector2d(-by[k].in_stop.x, -by[k].in_stop.y));
    if (!aim_moves.allFinite()) return false;
    (k == 0 ? seen.by_x : seen.by_y) = by[k].pixel + aim_moves[0] * by[2].pixel + aim_moves[1] * by[3].pixel;
  }
  return true;
}

std::optional<ImagedPoint> Camera::see(Vec2d place, Pose<double> const& plane) const {
  ImagedPoint seen;
  seen.place = place;
  Vec3d const point = plane.point_to_outer({place.x, place.y, 0});
  auto const aim = chief_aim(point);
  if (!aim || !differentiate(*aim, plane, seen)) return std::nullopt;
  seen.chief = towards(point, *aim);
  return seen;
}

std::optional<ImagedPoint> Camera::unproject(Vec2d pixel, Pose<double> const& plane) const {
  // Start where the camera's axis meets the plane.
  Ray<double> const axis = plane.inwards(Ray<double>{pose.origin, -1.0 * pose.z});
  if (!(std::abs(axis.direction.z) > 0)) return std::nullopt;
  double const way = -axis.position.z / axis.direction.z;
  Vec2d const start{axis.position.x + way * axis.direction.x, axis.position.y + way * axis.direction.y};
  auto const seen = find_place_and_aim(pixel, plane, start);
  return seen ? seen : find_place(pixel, plane, start);
}

std::optional<ImagedPoint> Camera::find_place(Vec2d pixel, Pose<double> const& plane, Vec2d place) const {
  constexpr int most_iterations = 60;
  auto const pixel_of = [&](Vec2d p) { return project(plane.point_to_outer({p.x, p.y, 0})); };
  auto here = pixel_of(place);
  for (int iteration = 0; here && length(*here - pixel) > 1e-9 && iteration < most_iterations; ++iteration) {
    auto const seen = see(place, plane);
    if (!seen) return std::nullopt;
    Vec2d const miss = pixel - *here;
    double const determinant = seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x;
    if (determinant == 0) return std::nullopt;
    Vec2d const change{(miss.x * seen->by_y.y - miss.y * seen->by_y.x) / determinant,
                       (seen->by_x.x * miss.y - seen->by_x.y * miss.x) / determinant};
    // Halve the step until it stays within the field and reduces the error.
    bool better = false;
    for (double share = 1; share > 1e-3 && !better; share /= 2) {
      auto const there = pixel_of(place + share * change);
      if (!there || !(length(*there - pixel) < length(miss))) continue;
      place += share * change;
      here = there;
      better = true;
    }
    if (!better) break;
  }
  return here && length(*here - pixel) < 1e-6 ? see(place, plane) : std::nullopt;
}

std::optional<ImagedPoint> Camera::find_place_and_aim(Vec2d pixel, Pose<double> const& plane, Vec2d place) const {
  auto const point = [&](Vec2d p) { return plane.point_to_outer({p.x, p.y, 0}); };
  auto const found = chief_aim(point(place));
  if (!found) return std::nullopt;
  Vec2d aim = *found;
  auto here = sight(point(place), aim);
  if (!here) return std::nullopt;
  // Newton's method for position and aim together: the ray must meet the stop's centre and the pixel.
  double const h = place_step(plane), unit_in_stop = in_stop_unit();
  auto const miss_of = [&](Sight const& s) {
    return std::hypot(length(s.in_stop) / unit_in_stop, length(s.pixel - pixel));
  };
  for (int iteration = 0; iteration < 50 && miss_of(*here) > 1e-9; ++iteration) {
    Vec2d const unit[2] = {{1, 0}, {0, 1}};
    Eigen::Matrix4d by_place_and_aim;
    for (int k = 0; k < 4; ++k) {
      auto const there =
          k < 2 ? sight(point(place + h * unit[k]), aim) : sight(point(place), aim + aim_step * unit[k - 2]);
      if (!there) return std::nullopt;
      double const by = k < 2 ? h : aim_step;
      Vec2d const stop_change = (there->in_stop - here->in_stop) / by, pixel_change = (there->pixel - here->pixel) / by;
      by_place_and_aim.col(k) << stop_change.x, stop_change.y, pixel_change.x, pixel_change.y;
    }
    Vec2d const to_pixel = pixel - here->pixel;
    Eigen::Vector4d const change = by_place_and_aim.partialPivLu().solve(
        Eigen::Vector4d(-here->in_stop.x, -here->in_stop.y, to_pixel.x, to_pixel.y));
    if (!change.allFinite()) return std::nullopt;
    bool better = false;
    for (double share = 1; share > 1e-3 && !better; share /= 2) {
      Vec2d const new_place = place + share * Vec2d{change[0], change[1]},
                  new_aim = aim + share * Vec2d{change[2], change[3]};
      auto const there = sight(point(new_place), new_aim);
      if (!there || !(miss_of(*there) < miss_of(*here))) continue;
      place = new_place;
      aim = new_aim;
      here = there;
      better = true;
    }
    if (!better) break;
  }
  if (!(miss_of(*here) < 1e-6)) return std::nullopt;
  ImagedPoint seen;
  seen.place = place;
  seen.chief = towards(point(place), aim);
  if (!differentiate(aim, plane, seen)) return std::nullopt;
  return seen;
}

double Camera::pupil_safety_factor() { return ellipse_safety_factor(rim_points); }

std::optional<WorldApparentPupil> Camera::apparent_pupil(Vec3d source) const {
  if (chief_rays_only()) {
    auto const aim = chief_aim(source);
    if (!aim) return std::nullopt;
    return WorldApparentPupil{aim_plane.point_to_outer({aim->x, aim->y, 0}), {}, {}};
  }
  auto const disc = find_apparent_pupil(stop_sight(source), paraxial_aim(source), rim_points);
  if (!disc) return std::nullopt;
  auto const along = [this](Vec2d v) { return aim_plane.direction_to_outer({v.x, v.y, 0}); };
  return WorldApparentPupil{aim_plane.point_to_outer({disc->centre.x, disc->centre.y, 0}), along(disc->a),
                            along(disc->b)};
}

Vec2d Camera::ideal_project(Vec3d point) const {
  Vec3d const q = pose.point_to_local(point);
  double const distance = paraxial.front - q.z, slope = paraxial.chief_slope(distance);
  double const height = 1 + slope * (distance - paraxial.window_shift);  // height of the chief ray at the first surface
                                                                         // per height of the point
  double const out = paraxial.whole.a * height + paraxial.whole.b * slope;
  double const out_slope = paraxial.whole.c * height + paraxial.whole.d * slope;
  Ray<double> const leaving{{out * q.x, out * q.y, 0}, {out_slope * q.x, out_slope * q.y, paraxial.forwards}};
  Ray<double> const local = sensor.pose.inwards(pose.outwards(paraxial.behind.outwards(leaving)));
  double const way = -local.position.z / local.direction.z;
  return sensor.undistorted_pixel(local.position.x + way * local.direction.x,
                                  local.position.y + way * local.direction.y);
}

}  // namespace gladstone::inline scene
