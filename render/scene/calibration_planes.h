#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Returns the setup of one plane of a calibration, rendered ray by ray. The camera is unchanged: its focus and tilt
/// remain those for Z = 0.
/// @param z  position of the plane [m]
Setup plane_setup(Setup const& setup, double z);

/// Pinhole camera in OpenCV's convention: x right, y down, z into the scene. With d = R X + t and (x, y) = (d.x, d.y) /
/// d.z, distorted by BrownDistortion, the pixel is (fx x + cx, fy y + cy).
struct Pinhole {
  double fx, fy, cx, cy;  ///< focal lengths and principal point [px]
  BrownDistortion<double> brown;
  std::array<Vec3d, 3> rows;  ///< rows of the rotation R from world to camera
  Vec3d translation;          ///< translation t [m]
};

/// Returns the pinhole camera that is equivalent to a setup's ideal thin lens. For a tilted sensor, its z axis is the
/// sensor's normal, and (cx, cy) is where the normal through the lens meets the sensor.
/// @return nullopt without an equivalent: for a prescription, other optical elements, and for a tilted sensor with
/// distortion, whose centre of distortion is not (cx, cy)
std::optional<Pinhole> equivalent_pinhole(Setup const& setup, Camera const& camera);

/// Checks a calibration setup: object distances that the lens can image, elements in front of all planes, diameter and
/// spacing of the dots in the image.
void cross_check_calibration(Setup const& setup, SetupTable root, Warnings& warnings);

}  // namespace gladstone::inline scene
