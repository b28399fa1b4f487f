#pragma once

#include "render/light/sources.h"
#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"

namespace gladstone::inline rays {

/// Flat Lambertian sources of a target, in the form required by the general renderer: points in space with an angular
/// intensity. A source type provides place(), point(), intensity(), key(), middle(), reach() and area().
template <class T>
struct LambertSources {
  SourcesView<T> dots;

  /// Maps uniform random numbers u, v in [0, 1) to a position in the unit disc or the square [-1, 1]^2.
  GLADSTONE_HD Vec2<T> place(T u, T v) const {
    using std::sqrt;
    if (dots.shape == SourceShape::disc) return point_on_circle(sqrt(u), v);
    return {T(2) * u - T(1), T(2) * v - T(1)};
  }
  /// Returns the point of source i at a position of place() [m]. Sources are symmetric about the centre: -place is as
  /// likely as place.
  GLADSTONE_HD Vec3<T> point(std::uint64_t i, Vec2<T> place) const {
    return {dots.centre[i].x + dots.half_size * place.x, dots.centre[i].y + dots.half_size * place.y, dots.plane_z};
  }
  /// Returns the intensity in a direction (unit vector) per area, relative to the normal radiance of white paper.
  GLADSTONE_HD T intensity(std::uint64_t i, Vec3<T> direction) const {
    return (dots.radiance ? dots.radiance[i] : T(1)) * (direction.z > T(0) ? direction.z : T(0));
  }
  /// Key of the source's random numbers.
  GLADSTONE_HD std::uint64_t key(std::uint64_t i) const { return random_key({dots.centre[i].x, dots.centre[i].y}); }
  GLADSTONE_HD Vec3<T> middle(std::uint64_t i) const { return {dots.centre[i].x, dots.centre[i].y, dots.plane_z}; }
  /// Maximum distance of a point of the source from its centre [m].
  GLADSTONE_HD T reach() const {
    return dots.shape == SourceShape::disc ? dots.half_size : T(1.4142136) * dots.half_size;
  }
  /// Area of a source [m^2]; 0: point source.
  GLADSTONE_HD T area() const {
    return (dots.shape == SourceShape::disc ? T(3.14159265358979323846) : T(4)) * dots.half_size * dots.half_size;
  }
};

/// Target area of one source's rays: the entrance pupil as seen from the source, enlarged by a margin.
template <class T>
struct AimedBundle {
  Vec3<T> centre, a, b;    ///< rays are sent to centre + r (a cos + b sin), 0 <= r <= 1 [m]
  Vec3<T> across;          ///< area of that ellipse times its normal [m^2]; a unit vector for chief rays
  BundleView choice;       ///< choice of sampling points
  Vec3<T> by_x{}, by_y{};  ///< shift of `centre` per offset in x and y of the ray's start from the source's middle [1]
};

/// A ray at its source, and its weight: intensity times the solid angle of the whole target area as seen from the ray's
/// start. The mean weight of a source's rays is its light per area through the target area.
template <class T>
struct AimedRay {
  Ray<T> ray;
  T weight{};
};

/// Returns the ray from a position of source i to a point `at` of the unit disc that is mapped to the target area.
template <class T, class Sources>
GLADSTONE_HD AimedRay<T> ray_to(Sources const& sources, AimedBundle<T> const& bundle, std::uint64_t i, Vec2<T> place,
                                Vec2<T> at) {
  Vec3<T> const start = sources.point(i, place);
  Vec3<T> const offset = start - sources.middle(i);
  Vec3<T> const way =
      bundle.centre + at.x * bundle.a + at.y * bundle.b + offset.x * bundle.by_x + offset.y * bundle.by_y - start;
  T const far = length(way);
  AimedRay<T> aimed;
  aimed.ray = {start, way / far};
  T const facing = dot(aimed.ray.direction, bundle.across);
  aimed.weight = sources.intensity(i, aimed.ray.direction) * (facing < T(0) ? -facing : facing) / (far * far);
  return aimed;
}

/// Returns ray j of source i. The cos^4 law of flat targets results from the geometry and is not applied explicitly.
/// Rays of a scrambling come in pairs with the same point of the pupil and opposite positions on the source. If the
/// stop blocks a pair in one image only, the centroid then loses a contribution from the source's centre instead of one
/// from a random position.
template <class T, class Sources>
GLADSTONE_HD AimedRay<T> aim_ray(Sources const& sources, AimedBundle<T> const& bundle, std::uint64_t i,
                                 std::uint64_t j) {
  using std::sqrt;
  int const bits = bundle.choice.scrambling_bits;
  std::uint64_t const of_scrambling = j >> bits, scrambling = j & ((std::uint64_t{1} << bits) - 1);
  T u[sobol_dimensions];
  sample_coordinates(bundle.choice, sources.key(i), ((of_scrambling >> 1) << bits) | scrambling, u);
  Vec2<T> const place = sources.place(u[2], u[3]);
  return ray_to(sources, bundle, i, of_scrambling % 2 == 0 ? place : -place, point_on_circle(sqrt(u[0]), u[1]));
}

/// Adds a hit to a sum. @param origin  position to which the sum is relative [px]
template <class T>
GLADSTONE_HD void add_hit(RayHit<T> const& hit, Vec2<T> origin, CentroidSum<T>& sum) {
  if (hit.weight != T(0)) sum.add(hit.pixel - origin, hit.weight, reaches_sensor_plane(hit.status));
}

/// Returns the squared deflection of a ray by the medium on the aim plane [m^2]; 0 if unknown.
template <class T>
GLADSTONE_HD T squared_deflection(RayHit<T> const& ambient, RayHit<T> const& seen) {
  if (ambient.status > RayStatus::vignetted || seen.status > RayStatus::vignetted) return T(0);
  Vec2<T> const shift = seen.at_lens - ambient.at_lens;
  return dot(shift, shift);
}

/// Adds the results of one ray in both images to status counts, centroid sums and light.
/// @param origin  position to which the sums are relative [px]
/// @param hits  sums of the ray's scrambling, for both images
/// @param count  called as (frame, status)
/// @param deposit  called as (frame, hit) if the ray arrives with weight
/// @return squared deflection on the aim plane [m^2]; 0 if unknown
template <class T, class Count, class Deposit>
GLADSTONE_HD T enter_ray(RayHit<T> const& reference, RayHit<T> const& flow, Vec2<T> origin,
                         CentroidSum<T> (&hits)[frame_count], Count&& count, Deposit&& deposit) {
  for (int frame = 0; frame < frame_count; ++frame) {
    RayHit<T> const& here = frame == 0 ? reference : flow;
    count(frame, here.status);
    if (here.weight == T(0)) continue;
    add_hit(here, origin, hits[frame]);
    deposit(frame, here);
  }
  return squared_deflection(reference, flow);
}

}  // namespace gladstone::inline rays
