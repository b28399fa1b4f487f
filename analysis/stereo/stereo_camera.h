#pragma once

#include <optional>
#include <vector>

#include "analysis/calibration/pinhole_fit.h"
#include "render/base/vec.h"

namespace gladstone::inline stereo {

/// Pinhole camera with the covariance of its parameters.
struct CalibratedCamera {
  PinholeCamera camera;
  std::vector<double> covariance;  ///< covariance as in PinholeFit::covariance [count x count]; empty: exact parameters
};

/// Plane z = height + slope . (x, y) in world coordinates: the middle of a laser sheet.
struct ObjectPlane {
  double height = 0.0;  ///< z at x = y = 0 [m]
  Vec2d slope{};        ///< dz/dx and dz/dy [1]

  Vec3d point(Vec2d at) const { return {at.x, at.y, height + dot(slope, at)}; }
};

/// Line of sight of a pixel.
struct SightLine {
  Vec3d origin;     ///< position of the pinhole [m]
  Vec3d direction;  ///< unit vector into the scene [1]
};

/// Computes the line of sight of a pixel: the inverse of PinholeCamera::project. The distortion is inverted by Newton's
/// method.
/// @return nullopt if the distortion cannot be inverted at this pixel
std::optional<SightLine> find_sight_line(PinholeCamera const& camera, Vec2d pixel);

/// Computes the intersection of a pixel's line of sight with a plane.
/// @return x and y of the point [m]; nullopt if the line does not meet the plane in front of the camera
std::optional<Vec2d> intersect_plane(PinholeCamera const& camera, Vec2d pixel, ObjectPlane const& plane);

/// Computes the position of the pinhole in the world [m].
Vec3d find_pinhole(PinholeCamera const& camera);

/// Computes the size of a pixel projected onto a plane at x = y = 0: the square root of its area [m].
double find_pixel_size(PinholeCamera const& camera, ObjectPlane const& plane);

/// Computes the angle between the directions from a point to both pinholes [rad].
double find_view_angle(PinholeCamera const& a, PinholeCamera const& b, Vec3d point);

}  // namespace gladstone::inline stereo
