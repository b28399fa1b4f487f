#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline scene {

/// Pinhole projection through an ideal thin lens on the Z axis to a sensor perpendicular to it.
struct IdealProjection {
  double image_distance = 0;  ///< lens to sensor [m]
  double lens_z = 0;          ///< position of the lens on the Z axis [m]
  double pixel_pitch = 1;     ///< [m]
  int columns = 0, rows = 0;  ///< size of the sensor [px]

  /// Returns the image position of a point [px].
  GLADSTONE_HD Vec2d operator()(Vec3d place) const {
    double const scale = image_distance / (lens_z - place.z) / pixel_pitch;
    return {0.5 * (columns - 1) + scale * place.x, 0.5 * (rows - 1) - scale * place.y};
  }
  /// Returns a vector from the lens towards the points whose image is at a position [px], with z = -1.
  GLADSTONE_HD Vec3d direction(Vec2d pixel) const {
    double const slope = pixel_pitch / image_distance;
    return {slope * (pixel.x - 0.5 * (columns - 1)), -slope * (pixel.y - 0.5 * (rows - 1)), -1};
  }
};

}  // namespace gladstone::inline scene
