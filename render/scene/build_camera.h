#pragma once

#include "render/scene/camera.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Returns the paraxial model (ray-transfer matrices) of a setup's lens and other optical elements.
ParaxialCamera paraxial_camera(Setup const& setup);

/// Returns the pose of the last vertex of the lens (an ideal thin lens: of the lens) in the world, with z along the
/// light that leaves it.
Pose<double> lens_exit(Setup const& setup);

/// Computes image distance, magnification and entrance pupil from a paraxial model; see Setup::imaging().
ImagingGeometry paraxial_imaging(Setup const& setup, ParaxialCamera const& paraxial);

/// Returns the tilt of a setup's sensor about its x axis, then about its rotated y axis [rad]: the configured tilt or,
/// for scheimpflug = "auto", the one that images the plane Z = const through the point in focus sharply everywhere.
Vec2d sensor_tilt(Setup const& setup);

/// Returns width and height, centred on target_centre(), of the part of the dots' plane that a posed or tilted camera
/// sees [m].
Vec2d posed_view(Setup const& setup);
/// Like posed_view(), enlarged on all sides by Setup::view_margin_px and rounded up to whole micrometres [m].
Vec2d posed_extent(Setup const& setup);

/// Returns Setup::pixel_size() of a posed or tilted camera [m].
/// @throws DataError if the camera does not see the centre of the target
double posed_pixel_size(Setup const& setup);

/// Returns the area of the dots' plane that a posed or tilted camera sees [m^2]: that of the polygon through four
/// points on each edge of the image, since distortion curves the edges.
double posed_view_area(Setup const& setup);

/// Builds the focused camera of a setup.
/// An ideal thin lens without other optical elements is focused by the lens formula. Otherwise the sensor is moved
/// along the axis to the best focus (least squares) of rays traced from the axis point of the plane in focus.
/// @throws DataError if the plane in focus has no real image or too few rays reach the sensor
Camera build_camera(Setup const& setup);

}  // namespace gladstone::inline scene
