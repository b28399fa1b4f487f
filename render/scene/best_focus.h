#pragma once

#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone {

/// By how much a camera's sensor is to be moved along its axis, so that the bundle of a point, traced through stop and
/// glass, is narrowest there: the least of its mean square radius, which rays make a parabola along the axis [m].
/// @throws DataError where too few rays get through, or they meet nowhere
double best_focus(Camera const& camera, Vec3d point);

/// Places the lens of a setup whose sensor stands at setup.z_sensor on the Z axis: sets z_a, so that the best focus of
/// the point in focus falls on the sensor. Of the two places that a thin lens has (Bessel) it takes the one nearer the
/// sensor. Ceres finds it on Jets of the traced rays (dual numbers, which carry derivatives by the lens' place).
/// @throws DataError where no place of the lens images the plane in focus on the sensor
void place_lens_by_sensor(Setup& setup);

}  // namespace gladstone
