#pragma once

#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// Point k of `count` that fill the unit disc evenly, no two at one radius or angle: turned by the golden angle from
/// each to the next (Vogel 1979).
Vec2d sunflower(int k, int count);

/// What a bundle of rays leaves on a plane across them, and how narrow it gets along the plane's normal.
template <class T>
struct BundleSpot {
  Vec2<T> centroid{};    ///< [m]
  T mean_square{};       ///< of the distance from it [m^2]
  T best_focus{};        ///< where the bundle is narrowest, from the plane [m]
  T best_mean_square{};  ///< there [m^2]
};

/// The rms radius is a parabola along the normal: <p p> + 2 z <p s> + z^2 <s s> about the means of places p and slopes
/// s.
/// @param places,slopes of the rays in the plane's frame @pre as many of both, one or more
template <class T>
BundleSpot<T> spot_of(std::vector<Vec2<T>> const& places, std::vector<Vec2<T>> const& slopes) {
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

}  // namespace gladstone
