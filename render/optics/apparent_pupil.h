#pragma once

#include <functional>
#include <optional>

#include "render/optics/lens.h"

namespace gladstone::inline optics {

/// Origin of a bundle of rays, in the lens' frame: a point source, or a direction of parallel rays.
struct RayOrigin {
  bool at_infinity = false;
  Vec3d place{};  ///< position of the source [m], or unit direction of propagation

  static RayOrigin point(Vec3d p) { return {false, p}; }
  static RayOrigin direction(Vec3d d) { return {true, normalized(d)}; }
  /// Returns the ray through a point (x, y) [m] of the aim plane, the tangent plane of the first vertex. It starts at
  /// the point source or, for parallel rays, 1 m ahead of the plane.
  Ray<double> ray_through(Vec2d p) const;
};

/// Entrance pupil as seen from a source: footprint, on the aim plane, of the rays that pass the stop. Represented by an
/// ellipse, centre + a cos + b sin, and determined by ray tracing. It therefore accounts for the shift and
/// shrinkage of the pupil off the axis, and for telecentric lenses, whose entrance pupil is at infinity.
struct ApparentPupil {
  Vec2d centre{};  ///< intersection of the chief ray, through the centre of the stop, with the aim plane [m]
  Vec2d a{}, b{};  ///< conjugate semi-axes [m]

  Vec2d at(Vec2d unit_disc) const { return centre + unit_disc.x * a + unit_disc.y * b; }
};

/// Mapping of the rays of one source from the aim plane to the stop.
struct StopMapping {
  /// Intersection with the stop, in the stop's frame [m], of the ray through a point of the aim plane; nullopt if the
  /// ray does not reach the stop. Vignetted rays count as reaching it.
  std::function<std::optional<Vec2d>(Vec2d)> place;
  double radius = 0;   ///< radius of the stop [m]
  double step = 0;     ///< step of finite differences on the aim plane [m]
  RayOrigin origin{};  ///< source of the rays, in the aim plane's frame
  /// Line ahead of the lens, in the aim plane's frame, of the ray through the centre of the stop with a given slope
  /// (dx/dz, dy/dz) in the stop's frame, traced backwards. Empty if the lens does not support backward tracing.
  std::function<std::optional<Ray<double>>(Vec2d)> trace_back{};
};

/// Solves sight.place(aim) = target by a damped Newton method with finite differences.
/// @param target     point of the stop [m]
/// @param aim        initial guess, replaced by the last iterate [m]
/// @param tolerance  accuracy, relative to the radius of the stop. If rounding stops the iteration earlier, 1000 times
/// the tolerance is accepted.
/// @return false if no solution is found
bool aim_at(StopMapping const& sight, Vec2d target, Vec2d& aim, double tolerance = 1e-10);

/// Returns the point of the aim plane on the chief ray, which passes the centre of the stop; nullopt if it is not
/// found. Newton's method starts at the guess, then at the centre of the aim plane. If both fail, as for wide-angle
/// lenses, whose entrance pupil moves with the field angle, it starts from a ray traced backwards from the stop to the
/// source.
/// @param guess  point of the paraxial chief ray [m]
std::optional<Vec2d> find_chief_aim(StopMapping const& sight, Vec2d guess);

/// Returns the safety factor by which the ellipse fitted to a number of rim points is enlarged.
double ellipse_safety_factor(int rim_points);

/// Determines the entrance pupil as seen from a source, enlarged by ellipse_safety_factor() so that it contains all
/// rays that pass the stop.
/// @param guess       initial guess of the chief ray's point on the aim plane [m]
/// @param rim_points  number of rays aimed at the rim of the stop; more points allow a smaller margin
/// @return nullopt if no ray reaches the centre of the stop
std::optional<ApparentPupil> find_apparent_pupil(StopMapping const& sight, Vec2d guess, int rim_points);

/// Determines the entrance pupil of a lens for an origin of rays. Returns nullopt if no ray reaches the centre of the
/// stop, because of total internal reflection or because the rays miss the lens.
std::optional<ApparentPupil> find_apparent_pupil(Lens const& lens, RayOrigin const& origin);

/// Returns the intersection of a ray with the stop, in the stop's frame [m]; nullopt if the ray does not reach the
/// stop. Vignetted rays count as reaching it.
std::optional<Vec2d> intersect_stop(Lens const& lens, Ray<double> ray);

}  // namespace gladstone::inline optics
