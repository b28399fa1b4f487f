#include "render/optics/ray_bundle.h"

#include <algorithm>
#include <cmath>

#include "render/base/units.h"

namespace gladstone {

Vec2d sunflower(int k, int count) {
  double const golden_angle = pi * (3 - std::sqrt(5.0)), r = std::sqrt((k + 0.5) / count);
  return {r * std::cos(k * golden_angle), r * std::sin(k * golden_angle)};
}

BundleSpot spot_of(std::vector<Vec2d> const& places, std::vector<Vec2d> const& slopes) {
  auto const count = static_cast<double>(places.size());
  Vec2d place{}, slope{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    place += places[i];
    slope += slopes[i];
  }
  BundleSpot spot;
  spot.centroid = place / count;
  double pp = 0, ps = 0, ss = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Vec2d const p = places[i] - place / count, s = slopes[i] - slope / count;
    pp += dot(p, p);
    ps += dot(p, s);
    ss += dot(s, s);
  }
  spot.mean_square = pp / count;
  spot.best_focus = ss > 0 ? -ps / ss : 0;
  spot.best_mean_square = std::max(0.0, (pp + spot.best_focus * ps) / count);
  return spot;
}

}  // namespace gladstone
