#pragma once

#include <optional>

#include "render/optics/lens.h"

namespace gladstone {

/// Where a bundle of rays comes from, in the lens' frame: a point, or a direction that all of them share.
struct RayOrigin {
  bool at_infinity = false;
  Vec3d place{};  ///< the point [m], or the unit direction of travel

  static RayOrigin point(Vec3d p) { return {false, p}; }
  static RayOrigin direction(Vec3d d) { return {true, normalized(d)}; }
  /// The ray that runs through a point (x, y) of the tangent plane of the first vertex, begun well in front of it.
  Ray<double> ray_through(Vec2d p) const;
};

/// What a source sees of the lens' stop: the footprint of its rays that pass the stop on the tangent plane of the first
/// vertex, as an ellipse, centre + a cos + b sin. Found by tracing rays, so it holds off the axis, for pupils that
/// move and shrink, and for telecentric lenses, whose entrance pupil lies at infinity.
struct AimDisc {
  Vec2d centre{};  ///< where the chief ray, which meets the stop's centre, passes [m]
  Vec2d a{}, b{};  ///< conjugate semi-axes [m]

  Vec2d at(Vec2d unit_disc) const { return centre + unit_disc.x * a + unit_disc.y * b; }
  double area() const;
};

/// @return the disc, holding every ray that passes the stop, a little wide; nothing where no ray of this origin meets
/// the stop's centre (total internal reflection, or it looks past the lens)
std::optional<AimDisc> find_aim_disc(Lens const& lens, RayOrigin const& origin);

/// Where a ray meets the stop's own plane frame [m]; nothing where it is lost on the way (vignetted rays are not).
std::optional<Vec2d> place_in_stop(Lens const& lens, Ray<double> ray);

}  // namespace gladstone
