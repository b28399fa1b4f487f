#pragma once

#include "render/light/sources.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"

namespace gladstone {

/// Flat Lambertian sources of a target, as the general renderer takes sources: points in space with an intensity by
/// direction. Every kind has place(), point(), intensity(), key(), middle(), reach(), area(); another is another
/// such struct.
template <class T>
struct LambertSources {
  SourcesView<T> dots;

  /// A place of the unit disc, or of the square from -1 to 1; u and v are uniform in [0, 1).
  GLADSTONE_HD Vec2<T> place(T u, T v) const {
    using std::sqrt;
    if (dots.shape == SourceShape::disc) return point_of_circle(sqrt(u), v);
    return {T(2) * u - T(1), T(2) * v - T(1)};
  }
  /// The point of source i at such a place. Sources are symmetric about the middle: -place is as likely as place.
  GLADSTONE_HD Vec3<T> point(std::uint64_t i, Vec2<T> place) const {
    return {dots.centre[i].x + dots.half_size * place.x, dots.centre[i].y + dots.half_size * place.y, dots.plane_z};
  }
  /// Light that it sends into a direction (unit length), per solid angle and area, relative to white paper seen
  /// squarely.
  GLADSTONE_HD T intensity(std::uint64_t i, Vec3<T> direction) const {
    return (dots.radiance ? dots.radiance[i] : T(1)) * (direction.z > T(0) ? direction.z : T(0));
  }
  /// That its random numbers are keyed by.
  GLADSTONE_HD std::uint64_t key(std::uint64_t i) const { return key_of({dots.centre[i].x, dots.centre[i].y}); }
  GLADSTONE_HD Vec3<T> middle(std::uint64_t i) const { return {dots.centre[i].x, dots.centre[i].y, dots.plane_z}; }
  /// Furthest that a point lies from the middle [m].
  GLADSTONE_HD T reach() const {
    return dots.shape == SourceShape::disc ? dots.half_size : T(1.4142136) * dots.half_size;
  }
  /// [m^2]; 0: a point
  GLADSTONE_HD T area() const {
    return (dots.shape == SourceShape::disc ? T(3.14159265358979323846) : T(4)) * dots.half_size * dots.half_size;
  }
};

/// Where the rays of one source go, and which they are: what one source sees of the stop, widened.
template <class T>
struct AimedBundle {
  Vec3<T> centre, a, b;  ///< rays are sent to centre + r (a cos + b sin), r up to 1 [m]
  Vec3<T> across;        ///< area of that ellipse times its normal [m^2]; a unit vector for chief rays
  BundleView<T> choice;  ///< of the points; its pupil is not looked at
};

/// A ray as it leaves its source, and what it is worth: intensity times the solid angle of the whole aim disc, seen
/// from its point. The mean over a source's rays is its light, per area, that goes through the disc.
template <class T>
struct AimedRay {
  Ray<T> ray;
  T weight{};
};

/// The ray from a place of source i to a point of the aim disc, which is a unit disc.
template <class T, class Sources>
GLADSTONE_HD AimedRay<T> ray_to(Sources const& sources, AimedBundle<T> const& bundle, std::uint64_t i, Vec2<T> place,
                                Vec2<T> at) {
  Vec3<T> const start = sources.point(i, place);
  Vec3<T> const way = bundle.centre + at.x * bundle.a + at.y * bundle.b - start;
  T const far = length(way);
  AimedRay<T> aimed;
  aimed.ray = {start, way / far};
  T const facing = dot(aimed.ray.direction, bundle.across);
  aimed.weight = sources.intensity(i, aimed.ray.direction) * (facing < T(0) ? -facing : facing) / (far * far);
  return aimed;
}

/// Sends ray j of source i to the aim disc. cos^4 of plane pictures is in it and written nowhere.
///
/// Rays of a scrambling come in pairs, to one point of the disc from opposite places of the source: what the stop takes
/// of them in one frame and not in the other then moves the centroid by the source's middle, not by the scatter of
/// places over it.
template <class T, class Sources>
GLADSTONE_HD AimedRay<T> aim_ray(Sources const& sources, AimedBundle<T> const& bundle, std::uint64_t i,
                                 std::uint64_t j) {
  using std::sqrt;
  int const bits = bundle.choice.scrambling_bits;
  std::uint64_t const of_scrambling = j >> bits, scrambling = j & ((std::uint64_t{1} << bits) - 1);
  T u[sobol_dimensions];
  sample_coordinates(bundle.choice, sources.key(i), ((of_scrambling >> 1) << bits) | scrambling, u);
  Vec2<T> const place = sources.place(u[2], u[3]);
  return ray_to(sources, bundle, i, of_scrambling % 2 == 0 ? place : -place, point_of_circle(sqrt(u[0]), u[1]));
}

/// Enters what became of one ray in both frames: its ends are counted, its hits summed, its light laid down.
/// @param origin that sums count from [px] @param hits of the ray's scrambling
/// @param count called as (frame, status) @param deposit called as (frame, hit) where light arrives
/// @return square of how far the medium moved it on the aim plane [m^2]; 0 where that is not known
template <class T, class Count, class Deposit>
GLADSTONE_HD T enter_ray(RayHit<T> const& reference, RayHit<T> const& flow, Vec2<T> origin,
                         CentroidSum<T> (&hits)[frame_count], Count&& count, Deposit&& deposit) {
  for (int frame = 0; frame < frame_count; ++frame) {
    RayHit<T> const& here = frame == 0 ? reference : flow;
    count(frame, here.status);
    if (here.weight == T(0)) continue;
    hits[frame].add(here.pixel - origin, here.weight, reaches_sensor_plane(here.status));
    deposit(frame, here);
  }
  if (reference.status > RayStatus::vignetted || flow.status > RayStatus::vignetted) return T(0);
  Vec2<T> const shift = flow.at_lens - reference.at_lens;
  return dot(shift, shift);
}

}  // namespace gladstone
