#pragma once

#include <cmath>

#include "render/base/random_variates.h"
#include "render/light/particle_setup.h"

/// Random properties of one particle, as functions of the seed and the particle's index only, for host and device.
namespace gladstone::inline light {

/// Draws a diameter [m] from one of the closed-form distributions, always positive.
/// @pre spread is not DiameterSpread::table
GLADSTONE_HD inline double draw_diameter(DiameterSpread spread, double middle, double width, KeyedEngine engine) {
  using std::exp;
  if (spread == DiameterSpread::lognormal) return middle * exp(width * normal_variate(engine));
  if (spread != DiameterSpread::normal) return middle;
  double diameter;
  do {
    diameter = middle + width * normal_variate(engine);
  } while (!(diameter > 0));
  return diameter;
}

/// Returns the random engine for a particle's diameter, independent of the engine for its position.
GLADSTONE_HD inline KeyedEngine size_engine(std::uint64_t seed, std::uint64_t particle) {
  return {mix64(seed + 1), RandomStream::particles, particle};
}

/// Draws the position of a particle [m], uniform in a box. @param engine  {seed, RandomStream::particles, particle}
GLADSTONE_HD inline Vec3d draw_place(KeyedEngine& engine, Vec3d center, Vec3d size) {
  double const x = to_unit(engine()) - 0.5, y = to_unit(engine()) - 0.5, z = to_unit(engine()) - 0.5;
  return center + Vec3d{x * size.x, y * size.y, z * size.z};
}

/// Returns true if a position [m] is in a box.
GLADSTONE_HD inline bool is_inside_box(Vec3d place, Vec3d center, Vec3d size) {
  using std::abs;
  Vec3d const from = place - center;
  return 2 * abs(from.x) <= size.x && 2 * abs(from.y) <= size.y && 2 * abs(from.z) <= size.z;
}

}  // namespace gladstone::inline light
