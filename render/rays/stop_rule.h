#pragma once

#include <cstdint>
#include <vector>

#include "render/base/random.h"
#include "render/rays/particle_sources.h"

namespace gladstone {

/// A rule of integration over the unit disc: Gauss' in r^2 times equal angles, every other ring turned by half an angle
/// (Stroud, Approximate Calculation of Multiple Integrals, 1971, chapter 2). With k rings of 4 k it is exact for
/// polynomials of degree 4 k - 1. Every source turns it by an angle of its own.
///
/// Of rays that fill the stop just what lens and medium do to them is left to integrate, smooth functions of their
/// places: few nodes do as well as hundreds of points at random.
struct StopRuleView {
  double const* radius2 = nullptr;  ///< of the rings
  double const* share = nullptr;    ///< of a ring's rays, over that of equal shares
  int rings = 0;                    ///< 0: there is no rule, rays go to points of a sequence

  GLADSTONE_HD explicit operator bool() const { return rings > 0; }
  /// The angles of a ring.
  GLADSTONE_HD int angles() const { return 4 * rings; }
};

/// A place of the unit disc that a ray goes to.
struct StopPlace {
  Vec2d at;
  double share = 1;  ///< of the ray, over that of equal shares
};

/// Where ray j of the particle of that key goes. Scramblings have every other angle, or every fourth.
/// @param rule with as many nodes as there are rays; or none
GLADSTONE_HD inline StopPlace place_of_ray(StopRuleView const& rule, BundleView<double> const& choice,
                                           std::uint64_t key, std::uint64_t j) {
  using std::sqrt;
  if (!rule) return {place_of_ray(choice, key, j)};
  auto const angles = static_cast<std::uint64_t>(rule.angles());
  std::uint64_t const ring = j / angles, angle = j % angles;
  double const turned = to_unit(random_bits(choice.seed, RandomStream::pupil, key, 0));
  double const turn = (static_cast<double>(angle) + (ring % 2 == 0 ? 0.0 : 0.5)) / static_cast<double>(angles);
  return {point_of_circle(sqrt(rule.radius2[ring]), turn + turned), rule.share[ring]};
}

/// Owner of what a view shows.
class StopRule {
 public:
  StopRule() = default;
  /// @pre rays is four times the square of a whole number
  explicit StopRule(std::uint64_t rays);
  StopRuleView view() const { return {radius2_.data(), share_.data(), static_cast<int>(radius2_.size())}; }

 private:
  std::vector<double> radius2_, share_;
};

}  // namespace gladstone
