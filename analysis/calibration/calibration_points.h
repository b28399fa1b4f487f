#pragma once

#include <array>
#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// The lens that dots are seen through, as far as it moves the images of those out of focus: light that changes across
/// the aperture has its middle off the aperture's. Lengths in the world.
struct CalibratedLens {
  double pupil_radius = 0;      ///< of the entrance pupil, about the pinhole [m]; 0: chief rays only
  Vec3d focus_point{};          ///< of the plane that is imaged sharply [m]
  Vec3d focus_normal{0, 0, 1};  ///< of that plane [1]
};

/// What a camera is calibrated by: dots whose places in the world are known, and where they are seen.
struct CalibrationPoints {
  std::vector<Vec3d> world;  ///< centres of the dots, which are discs square to Z [m]
  std::vector<Vec2d> pixel;  ///< centroids of their images [px]
  double dot_radius = 0;     ///< [m]
  CalibratedLens lens;

  std::size_t size() const { return world.size(); }
};

/// Four places of a disc's plane, in units of its radius, over which the mean of any cubic polynomial is that over the
/// disc: the centroid of a dot's image is the mean of these points' images, where the image of its centre is not
/// (Heikkila, IEEE PAMI 22 (2000) 1066, on the bias that perspective makes of it).
inline constexpr double disc_rule = 0.70710678118654752;  // r / sqrt(2) along either axis
inline constexpr std::array<Vec2d, 4> disc_points{{{disc_rule, 0}, {-disc_rule, 0}, {0, disc_rule}, {0, -disc_rule}}};

}  // namespace gladstone
