#pragma once

#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Returns the distance by which the sensor must move along its normal to reach the best focus of an object point [m].
/// Traces a bundle of rays from the point through stop and lens. Its mean square radius is a parabola along the
/// sensor's normal; the best focus is the minimum.
/// @throws DataError if too few rays reach the sensor
double best_focus(Camera const& camera, Vec3d point);

/// Positions the lens of a setup whose sensor is fixed at setup.z_sensor on the Z axis: sets z_a such that the best
/// focus of the plane in focus lies on the sensor.
/// A thin lens has two such positions (Bessel); the one nearer the sensor is chosen. For prescriptions and cameras
/// with other optical elements, Ceres refines the paraxial position with automatic derivatives (Jets) of the traced
/// rays.
/// @throws DataError if no lens position images the plane in focus onto the sensor
void position_lens_from_sensor(Setup& setup);

}  // namespace gladstone::inline scene
