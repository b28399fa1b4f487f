#pragma once

#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline optics {

/// Returns point k of `count` points that fill the unit disc uniformly (sunflower pattern, Vogel 1979). Successive
/// points are rotated by the golden angle, and no two have the same radius or angle.
Vec2d sunflower(int k, int count);

/// Size of a ray bundle's spot on a plane, and at its best focus along the plane's normal.
template <class T>
struct BundleSpot {
  Vec2<T> centroid{};    ///< centroid of the spot on the plane [m]
  T mean_square{};       ///< mean square distance from the centroid [m^2]
  T best_focus{};        ///< distance of the narrowest cross-section from the plane [m]
  T best_mean_square{};  ///< mean square distance from the centroid at best focus [m^2]
};

/// Computes the spot of a ray bundle. The mean square radius is a parabola along the normal, <p p> + 2 z <p s> + z^2 <s
/// s>, with positions p and slopes s relative to their means.
/// @param places  intersections of the rays with the plane, in its frame [m]
/// @param slopes  slopes of the rays relative to the plane's normal [1]
/// @pre both have the same size, at least one
template <class T>
BundleSpot<T> compute_bundle_spot(std::vector<Vec2<T>> const& places, std::vector<Vec2<T>> const& slopes) {
  T const count(static_cast<double>(places.size()));
  Vec2<T> place{}, slope{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    place += places[i];
    slope += slopes[i];
  }
  BundleSpot<T> spot;
  spot.centroid = place / count;
  T pp(0), ps(0), ss(0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    Vec2<T> const p = places[i] - place / count, s = slopes[i] - slope / count;
    pp += dot(p, p);
    ps += dot(p, s);
    ss += dot(s, s);
  }
  spot.mean_square = pp / count;
  spot.best_focus = ss > T(0) ? -ps / ss : T(0);
  T const best = (pp + spot.best_focus * ps) / count;
  spot.best_mean_square = best > T(0) ? best : T(0);
  return spot;
}

}  // namespace gladstone::inline optics
