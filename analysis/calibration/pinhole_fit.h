#pragma once

#include <array>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone::inline calibration {

/// Pinhole camera with Brown's distortion, with OpenCV's parameter names and conventions. For a world point X, let d =
/// R X + t, where R is the rotation by the vector (rx, ry, rz), (x, y) = (d.x, d.y) / d.z and r^2 = x^2 + y^2.
/// The pixel is (fx x' + cx, fy y' + cy), where
/// x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2),
/// y' = y (1 + k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x y.
/// The camera's x axis points to the right in the image, its y axis down and its z axis into the scene. A tilted sensor
/// (Scheimpflug) is also a pinhole camera: z is then the sensor's normal, and (cx, cy) is away from the image centre.
struct PinholeCamera {
  static constexpr std::size_t count = 14;
  static constexpr std::array<char const*, count> names{"fx", "fy", "cx", "cy", "k1", "k2", "p1",
                                                        "p2", "rx", "ry", "rz", "tx", "ty", "tz"};
  static constexpr std::array<char const*, count> units{"px", "px",  "px",  "px",  "1", "1", "1",
                                                        "1",  "rad", "rad", "rad", "m", "m", "m"};
  std::array<double, count> value{};

  double fx() const { return value[0]; }
  double fy() const { return value[1]; }
  double cx() const { return value[2]; }
  double cy() const { return value[3]; }
  /// Projects a point of the world to its pixel position.
  Vec2d project(Vec3d world) const;
  /// Computes the centroid of the image of a Lambertian dot, averaged over disc_points and over the entrance pupil.
  /// @param centre  centre of the dot [m]
  /// @param radius  radius of the dot [m]
  /// @param middle  point on the optical axis of the lens [m]
  Vec2d image_of_dot(Vec3d centre, double radius, Vec3d middle = {}, CalibratedLens const& lens = {}) const;
};

/// Result of a fit of PinholeCamera.
struct PinholeFit {
  PinholeCamera camera;
  /// Standard errors of the parameters to first order, from the scatter of the residuals.
  std::array<double, PinholeCamera::count> standard_error{};
  std::vector<double> covariance;  ///< covariance of the parameters [count x count], row-major
  std::vector<Vec2d> residual_px;  ///< measured minus fitted position
  double rms_px = 0;               ///< rms of the residuals per component
  bool converged = false;          ///< false if the maximum number of iterations was reached
};

/// Fits all fourteen parameters by non-linear least squares (Ceres). Fits once from the linear solution (Hartley &
/// Zisserman 2004, section 7.1) and once from the linear solution with its principal point moved to the image centre,
/// and returns the fit with the smaller sum of squared residuals.
/// @param middle_px  image centre
/// @throws std::invalid_argument if the points are coplanar or fewer than 12, which leaves the camera undetermined
PinholeFit fit_pinhole(CalibrationPoints const& points, Vec2d middle_px);

}  // namespace gladstone::inline calibration
