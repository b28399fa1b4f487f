#pragma once

#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone {

/// How paraxial light runs through a setup's lens and windows.
ParaxialCamera paraxial_camera(Setup const& setup);

/// Sizes that follow from it, see Setup::imaging().
ImagingGeometry paraxial_imaging(Setup const& setup, ParaxialCamera const& paraxial);

/// Tilt of a setup's sensor about its x, then its turned y: the camera's own, or for scheimpflug = "auto" the one that
/// images Z = const through the point in focus sharply all over [rad].
Vec2d sensor_tilt(Setup const& setup);

/// Width and height about target_centre() of what a turned or tilted camera sees of the dots' plane [m].
Vec2d posed_view(Setup const& setup);
/// The same with the setup's margin all round [m].
Vec2d posed_extent(Setup const& setup);

/// Setup::pixel_size() of a turned or tilted camera. @throws DataError where it sees nothing of the target's middle
double posed_pixel_size(Setup const& setup);

/// Area that a turned or tilted camera's picture takes on the dots' plane: of the polygon through several pixels of
/// each of its edges [m^2].
double posed_view_area(Setup const& setup);

/// The camera of a setup, focused: an ideal thin lens by its formula; a prescription, or any lens behind windows, by
/// moving the sensor along the axis to where the rays from the axis point of the plane in focus, traced through stop
/// and glass, come closest together (least squares). @throws DataError where no ray gets through, or they meet nowhere
Camera build_camera(Setup const& setup);

}  // namespace gladstone
