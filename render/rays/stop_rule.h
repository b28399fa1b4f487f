#pragma once

#include <cstdint>
#include <vector>

#include "render/base/random.h"
#include "render/rays/particle_sources.h"

namespace gladstone::inline rays {

/// Cubature rule over the unit disc: Gauss-Legendre in r^2 times equal angles, with every other ring rotated by half an
/// angular step (Stroud, Approximate Calculation of Multiple Integrals, 1971, chapter 2). With k rings of 4 k nodes, it
/// is exact for polynomials of degree 4 k - 1. Each source rotates the rule by its own random angle.
///
/// For rays that fill the stop, the integrand is the effect of lens and medium alone, a smooth function of the position
/// in the stop: a few nodes are as accurate as hundreds of random points.
struct StopRuleView {
  double const* radius2 = nullptr;  ///< squared radii of the rings
  double const* share = nullptr;    ///< weight of a ring's rays relative to equal weights
  int rings = 0;                    ///< number of rings; 0: no rule, rays are sent to points of a sequence

  GLADSTONE_HD explicit operator bool() const { return rings > 0; }
  /// Number of nodes of a ring.
  GLADSTONE_HD int angles() const { return 4 * rings; }
};

/// Point of the unit disc to which a ray is sent.
struct StopSamplePoint {
  Vec2d at;
  double share = 1;  ///< weight of the ray relative to equal weights
};

/// Returns the point of ray j of the particle with this key. A scrambling consists of every other node of a ring, or of
/// every fourth.
/// @param rule  rule with as many nodes as there are rays, or none
GLADSTONE_HD inline StopSamplePoint sample_stop_point(StopRuleView const& rule, BundleView const& choice,
                                                      std::uint64_t key, std::uint64_t j) {
  using std::sqrt;
  if (!rule) return {sample_stop_point(choice, key, j)};
  auto const angles = static_cast<std::uint64_t>(rule.angles());
  std::uint64_t const ring = j / angles, angle = j % angles;
  double const turned = to_unit(random_bits(choice.seed, RandomStream::pupil, key, 0));
  double const turn = (static_cast<double>(angle) + (ring % 2 == 0 ? 0.0 : 0.5)) / static_cast<double>(angles);
  return {point_on_circle(sqrt(rule.radius2[ring]), turn + turned), rule.share[ring]};
}

/// Owner of a StopRuleView's data.
class StopRule {
 public:
  StopRule() = default;
  /// @pre rays is four times the square of an integer
  explicit StopRule(std::uint64_t rays);
  StopRuleView view() const { return {radius2_.data(), share_.data(), static_cast<int>(radius2_.size())}; }

 private:
  std::vector<double> radius2_, share_;
};

}  // namespace gladstone::inline rays
