#pragma once

#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// Point k of `count` that fill the unit disc evenly, no two at one radius or angle: turned by the golden angle from
/// each to the next (Vogel 1979).
Vec2d sunflower(int k, int count);

/// What a bundle of rays leaves on a plane across them, and how narrow it gets along the plane's normal.
struct BundleSpot {
  Vec2d centroid{};             ///< [m]
  double mean_square = 0;       ///< of the distance from it [m^2]
  double best_focus = 0;        ///< where the bundle is narrowest, from the plane [m]
  double best_mean_square = 0;  ///< there [m^2]
};

/// The rms radius is a parabola along the normal: <p p> + 2 z <p s> + z^2 <s s> about the means of places p and slopes
/// s.
/// @param places,slopes of the rays in the plane's frame @pre as many of both, one or more
BundleSpot spot_of(std::vector<Vec2d> const& places, std::vector<Vec2d> const& slopes);

}  // namespace gladstone
