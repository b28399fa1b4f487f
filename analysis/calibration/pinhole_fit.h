#pragma once

#include <array>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone {

/// Parameters of a pinhole camera with Brown's distortion, by OpenCV's names and conventions. With R by rvec and d = R
/// X
/// + t, (x, y) = (d.x, d.y) / d.z and r^2 = x^2 + y^2 the pixel is (fx x' + cx, fy y' + cy), where
/// x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y (1 + k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x
/// y. The camera's x runs right, its y down, its z into the scene. A tilted sensor (Scheimpflug) is a pinhole camera
/// too: z is its normal then, and (cx, cy) lies off the picture's middle.
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
  /// The pixel of a point in the world.
  Vec2d project(Vec3d world) const;
  /// The centroid of the image of a Lambertian dot, see disc_points; over the lens's pupil likewise.
  /// @param middle of what the lens faces [m]
  Vec2d image_of_dot(Vec3d centre, double radius, Vec3d middle = {}, CalibratedLens const& lens = {}) const;
};

/// A camera fitted to points.
struct PinholeFit {
  PinholeCamera camera;
  std::array<double, PinholeCamera::count> standard_error{};  ///< from the residuals' scatter, to first order
  std::vector<double> covariance;                             ///< count x count
  std::vector<Vec2d> residual_px;                             ///< seen minus fitted
  double rms_px = 0;                                          ///< of the residuals, per component
  bool converged = false;                                     ///< within the iterations that are done at most
};

/// Fits all fourteen parameters by least squares (Ceres). Begins from the linear solution (Hartley & Zisserman 2004,
/// section 7.1) and from one with the principal point in the picture's middle; the better end counts.
/// @param middle_px of the picture
/// @throws std::invalid_argument where the points lie on one plane or are fewer than 12: these leave the camera open
PinholeFit fit_pinhole(CalibrationPoints const& points, Vec2d middle_px);

}  // namespace gladstone
