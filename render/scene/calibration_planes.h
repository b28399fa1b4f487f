#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone {

/// A calibration's setup with its dots on one plane: the camera stays the very same, focused and tilted as for Z = 0.
/// @param z of the plane [m]
Setup plane_setup(Setup const& setup, double z);

/// A pinhole camera as OpenCV writes it: x right, y down, z into the scene; with d = R X + t and (x, y) = (d.x, d.y) /
/// d.z, distorted as BrownDistortion says, the pixel is (fx x + cx, fy y + cy).
struct Pinhole {
  double fx, fy, cx, cy;  ///< [px]
  BrownDistortion<double> brown;
  std::array<Vec3d, 3> rows;  ///< of the rotation R, from the world to the camera
  Vec3d translation;          ///< t [m]
};

/// The pinhole camera that images as an ideal thin lens does. Of a tilted sensor its z is the sensor's normal, and (cx,
/// cy) is where the normal through the lens meets the sensor. Nothing where there is none: for a prescription, through
/// windows, and for a tilted sensor with distortion, which is about another point then.
std::optional<Pinhole> pinhole_of(Setup const& setup, Camera const& camera);

/// Checks of a calibration: planes within the reach of the lens, windows before all of them, sizes of dots in the
/// picture.
void cross_check_calibration(Setup const& setup, SetupTable root, std::vector<std::string>& warnings);

}  // namespace gladstone
