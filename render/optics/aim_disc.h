#pragma once

#include <functional>
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

/// How a source's rays come to a stop.
struct StopSight {
  /// Where the ray through a point of the aim plane meets the stop, in the stop's frame [m]; nothing where it is lost
  /// on the way (vignetted rays are not).
  std::function<std::optional<Vec2d>(Vec2d)> place;
  double radius = 0;   ///< of the stop [m]
  double step = 0;     ///< on the aim plane, that differences are taken over [m]
  RayOrigin origin{};  ///< in the aim plane's frame
  /// Line in front of the lens, in the aim plane's frame, of the ray that meets the stop's centre at a slope (dx/dz,
  /// dy/dz) in the stop's frame; empty: rays are not traced back.
  std::function<std::optional<Ray<double>>(Vec2d)> trace_back{};
};

/// Solves place(aim) = target by Newton's method with differences.
/// @param aim the first guess; becomes the solution @param tolerance in radii of the stop @return false: no ray goes
/// there
bool aim_at(StopSight const& sight, Vec2d target, Vec2d& aim, double tolerance = 1e-10);

/// Point of the aim plane that the chief ray passes, which meets the stop's centre. Where Newton's method reaches it
/// neither from the guess nor from the plane's centre, because a wide-angle lens has its entrance pupil elsewhere at
/// that field angle, it starts from the ray that is traced back from the stop to the source.
/// @param guess of the paraxial chief ray @return nothing where no ray meets the stop's centre
std::optional<Vec2d> find_chief_aim(StopSight const& sight, Vec2d guess);

/// By how much a disc is wider than the rim that it is found by.
double aim_margin(int rim_points);

/// @param guess where the chief ray may pass @param rim_points of the stop that are aimed at: the more, the narrower
/// the margin about them @return the disc, holding every ray that passes the stop, a little wide; nothing where no ray
/// meets the stop's centre
std::optional<AimDisc> find_aim_disc(StopSight const& sight, Vec2d guess, int rim_points);

/// The same for a lens. @return nothing where no ray of this origin meets the stop's centre (total internal reflection,
/// or it looks past the lens)
std::optional<AimDisc> find_aim_disc(Lens const& lens, RayOrigin const& origin);

/// Where a ray meets the stop's own plane frame [m]; nothing where it is lost on the way (vignetted rays are not).
std::optional<Vec2d> place_in_stop(Lens const& lens, Ray<double> ray);

}  // namespace gladstone
