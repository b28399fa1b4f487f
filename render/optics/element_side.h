#pragma once

namespace gladstone::inline optics {

/// Part of the light path in which an optical element is placed, in the order of the light, and the frame of its pose.
enum class ElementSide {
  target,      ///< ahead of the medium; world frame
  camera,      ///< between medium and lens; world frame
  sensor,      ///< between lens and sensor; frame of the last vertex of the lens, z along the light
  image_plane  ///< in the image plane of the lens, with the sensor behind it; frame of the image plane
};

/// List of types of surfaces.
template <class... Surfaces>
struct SurfaceTypes {};

}  // namespace gladstone::inline optics
