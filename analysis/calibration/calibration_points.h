#pragma once

#include <array>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline calibration {

/// Aperture and focal plane of the lens through which the dots are imaged. They are needed for defocused dots: if the
/// irradiance varies across the entrance pupil, the centroid of a defocused dot image deviates from the chief ray's
/// image point. All lengths are in world coordinates.
struct CalibratedLens {
  double pupil_radius = 0;      ///< radius of the entrance pupil, centred at the pinhole [m]; 0: chief rays only
  Vec3d focus_point{};          ///< point on the plane in focus [m]
  Vec3d focus_normal{0, 0, 1};  ///< unit normal of the plane in focus [1]
};

/// Input of a camera calibration: dots with known world positions and the measured positions of their images.
struct CalibrationPoints {
  std::vector<Vec3d> world;  ///< centres of the dots, which are discs perpendicular to Z [m]
  std::vector<Vec2d> pixel;  ///< centroids of the dot images [px]
  double dot_radius = 0;     ///< radius of the dots [m]
  CalibratedLens lens;

  std::size_t size() const { return world.size(); }
};

/// Quadrature points on a disc, in units of its radius. The mean of a cubic polynomial over the four points equals its
/// mean over the disc. The mean of the points' images is therefore the centroid of the dot image, whereas the image of
/// the disc's centre is biased by perspective (Heikkila, IEEE PAMI 22 (2000) 1066).
// distance of each point from the centre, in radii of the disc
inline constexpr double disc_rule = 0.70710678118654752;
inline constexpr std::array<Vec2d, 4> disc_points{{{disc_rule, 0}, {-disc_rule, 0}, {0, disc_rule}, {0, -disc_rule}}};

}  // namespace gladstone::inline calibration
