#include "analysis/stereo/stereo_camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace gladstone::inline stereo {
namespace {

Eigen::Matrix3d find_rotation(PinholeCamera const& camera) {
  Eigen::Vector3d const axis(camera.value[8], camera.value[9], camera.value[10]);
  double const angle = axis.norm();
  if (!(angle > 0.0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix();
}

/// Finds the undistorted image coordinates (x, y) of a pixel: without its pose, the camera projects the point (x, y, 1)
/// to this pixel.
std::optional<Vec2d> undistort(PinholeCamera camera, Vec2d pixel) {
  constexpr int max_iterations = 50;
  // tolerance, and step of the finite differences, of coordinates in the plane at unit distance from the camera
  constexpr double tolerance = 1e-13, step = 1e-6;
  std::fill(camera.value.begin() + 8, camera.value.end(), 0.0);
  auto const image = [&](Vec2d at) { return camera.project({at.x, at.y, 1.0}); };
  Vec2d at{(pixel.x - camera.cx()) / camera.fx(), (pixel.y - camera.cy()) / camera.fy()};
  for (int i = 0; i < max_iterations; ++i) {
    Vec2d const by_x = (image({at.x + step, at.y}) - image({at.x - step, at.y})) / (2 * step);
    Vec2d const by_y = (image({at.x, at.y + step}) - image({at.x, at.y - step})) / (2 * step);
    double const determinant = by_x.x * by_y.y - by_x.y * by_y.x;
    Vec2d const off = pixel - image(at);
    Vec2d const change{(by_y.y * off.x - by_y.x * off.y) / determinant,
                       (by_x.x * off.y - by_x.y * off.x) / determinant};
    at += change;
    if (!is_finite(at)) return std::nullopt;
    if (length(change) <= tolerance * (1.0 + length(at))) return at;
  }
  return std::nullopt;
}

}  // namespace

std::optional<SightLine> find_sight_line(PinholeCamera const& camera, Vec2d pixel) {
  std::optional<Vec2d> const at = undistort(camera, pixel);
  if (!at) return std::nullopt;
  Eigen::Vector3d const along = (find_rotation(camera).transpose() * Eigen::Vector3d(at->x, at->y, 1.0)).normalized();
  return SightLine{find_pinhole(camera), {along.x(), along.y(), along.z()}};
}

std::optional<Vec2d> intersect_plane(PinholeCamera const& camera, Vec2d pixel, ObjectPlane const& plane) {
  std::optional<SightLine> const line = find_sight_line(camera, pixel);
  if (!line) return std::nullopt;
  Vec3d const normal{-plane.slope.x, -plane.slope.y, 1.0};
  double const distance = (plane.height - dot(normal, line->origin)) / dot(normal, line->direction);
  if (!(distance > 0.0 && std::isfinite(distance))) return std::nullopt;
  Vec3d const point = line->origin + distance * line->direction;
  return Vec2d{point.x, point.y};
}

Vec3d find_pinhole(PinholeCamera const& camera) {
  Eigen::Vector3d const t(camera.value[11], camera.value[12], camera.value[13]);
  Eigen::Vector3d const centre = -(find_rotation(camera).transpose() * t);
  return {centre.x(), centre.y(), centre.z()};
}

double find_pixel_size(PinholeCamera const& camera, ObjectPlane const& plane) {
  constexpr double step = 1e-4;  // [m]
  Vec2d const middle = camera.project(plane.point({}));
  Vec2d const right = (camera.project(plane.point({step, 0})) - middle) / step;
  Vec2d const up = (camera.project(plane.point({0, step})) - middle) / step;
  return 1.0 / std::sqrt(std::abs(right.x * up.y - right.y * up.x));
}

double find_view_angle(PinholeCamera const& a, PinholeCamera const& b, Vec3d point) {
  Vec3d const to_a = normalized(find_pinhole(a) - point), to_b = normalized(find_pinhole(b) - point);
  return std::acos(std::clamp(dot(to_a, to_b), -1.0, 1.0));
}

}  // namespace gladstone::inline stereo
