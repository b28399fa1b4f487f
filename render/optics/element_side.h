#pragma once

namespace gladstone::inline optics {

/// Part of the light path in which an optical element is placed, in the order of the light, and the coordinate system
/// of its pose.
enum class ElementSide {
  target,      ///< ahead of the medium; pose in world coordinates
  camera,      ///< between medium and lens; pose in world coordinates
  sensor,      ///< between lens and sensor; pose in coordinates of the lens' last vertex, z along the light
  image_plane  ///< in the image plane of the lens, ahead of the sensor; pose in coordinates of that plane
};

/// List of types of surfaces.
template <class... Surfaces>
struct SurfaceTypes {};

}  // namespace gladstone::inline optics
