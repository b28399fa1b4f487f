#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/rays/source_truth.h"
#include "render/scene/ray_plan.h"

/// How many rays a source needs: from itself alone, and from what the camera makes of light.
namespace gladstone {

/// How rays are sent, which says how fast their errors fall.
enum class RaysSent {
  by_rule,  ///< to the nodes of a rule that fill the stop (stop_rule.h)
  clipped,  ///< to points of a sequence over a wider disc
};

/// What is asked of a source's light and truth.
struct RayGoal {
  double level = 0;         ///< light of one grey level; 0: no image is asked for
  double brightest_at = 0;  ///< grey levels of the brightest pixel
  double spot2 = 0;         ///< square of the radius of what a ray leaves, as a smooth spot [px^2]
  double most = 1;          ///< rays of a source

  /// About the light of the brightest pixel of a source. @param spread2 variance of its rays' places along an axis
  GLADSTONE_HD double peak(double light, double spread2) const {
    double const pixels = 2 * pi * (spot2 + spread2);
    return pixels > 1 ? light / pixels : light;
  }
  /// What its light may be off by, rms over its lit pixels, over its peak. Half a level for a source as bright as the
  /// camera is exposed for, and in proportion to the root of its light: of however many that lie over each other, short
  /// of saturation, the squares of errors then add up to half a level's.
  GLADSTONE_HD double allowed(double peak) const {
    using std::sqrt;
    double const share = peak / (brightest_at * level);
    return image_tolerance_levels * level * sqrt(share < 1 ? share : 1.0) / peak;
  }
};

/// What a rule of n nodes leaves of a picture, rms over lit pixels and over its peak, for rays that fill a disc: a
/// spot's Taylor series, integrated to degree 2 sqrt(n) - 1. Measured with discs of 0.05 to 4 times the spot's radius,
/// spots of 0.1 to 1.5 px and 4 to 1024 nodes: within a factor of 3, or a class of numbers.
/// @param ratio2 variance of the rays' places along an axis, over spot2
GLADSTONE_HD inline bool rule_serves(double n, double ratio2, double allowed) {
  using std::log;
  using std::sqrt;
  return sqrt(n) * log(ratio2 / (5 + 0.085 * n)) <= log(allowed);
}

/// What n rays to scrambled points leave of a picture, as above: for few of them the error of a variance, for many that
/// of their number within a spot's area. Measured with discs of 0.1 to 24 times the spot's radius, dots of 0 to 6 px,
/// 32 to 16,384 rays: within a factor of 3.
GLADSTONE_HD inline double left_by_points(double n, double ratio2) {
  using std::pow;
  double const within = n / (1 + ratio2 / 4);
  double const of_variance = within < 256 ? 8 * pow(within, -0.9) : 0.0544 * pow(within / 256, -1.2);
  double const left = ratio2 / (1 + ratio2) * of_variance;
  return left < 1 ? left : 1.0;
}

/// Rays that the spread of a source's image asks for. @param n to begin with
GLADSTONE_HD inline double rays_for_spread(RayGoal const& goal, RaysSent sent, double light, double spread2, double n) {
  if (!(goal.level > 0 && light > 0)) return n;
  double const allowed = goal.allowed(goal.peak(light, spread2)), ratio2 = spread2 / goal.spot2;
  if (sent == RaysSent::by_rule) {
    while (n < goal.most && !rule_serves(n, ratio2, allowed)) n *= 4;
  } else {
    while (n < goal.most && !(left_by_points(n, ratio2) <= allowed)) n *= 2;
  }
  return n;
}

/// What is known of a source before its rays are traced, in either frame.
struct RimSpread {
  double spread2[frame_count] = {};          ///< as FilledStop's, of rays that go by a rule
  bool clipped[frame_count] = {true, true};  ///< rays go to a wider disc than passes; none may get through
};

/// Rays that a source asks for by what its rays have come to: the scatter of its displacement between scramblings, that
/// of its light, and the spread of its image; `rays` where these are enough. One rule after the other is tried, since
/// errors fall at once or not at all; the scatter of points is taken to fall as 1/n.
///
/// Turning a rule of one ring or two does not tell what it leaves of aberrations, which are the same all round. Spread
/// as it was found beside that of the rim tells: these differ by all of what one ring leaves, and by more than four
/// times what two do (double Gauss and achromat, f/4 to f/11); four rings leave nothing.
/// @param of the scramblings @param light_per_weight of images
GLADSTONE_HD inline double rays_asked(RayGoal const& goal, RaysSent sent, RimSpread const& rim, RaySums const* of,
                                      int scramblings, double rays, double light_per_weight) {
  using std::pow;
  using std::sqrt;
  bool const by_rule = sent == RaysSent::by_rule;
  double asked = rays;
  auto const ask = [&asked](double n) {
    if (n > asked) asked = n;
  };
  RaySums all;
  for (int i = 0; i < scramblings; ++i) {
    all += of[i];
    for (int frame = 0; frame < frame_count; ++frame) {
      // what no ray shows is not known to be dark
      if (rim.clipped[frame] && !(of[i].hits[frame].weight > 0)) ask(4 * rays);
    }
  }
  if (scramblings > 1 && all.hits[0].weight > 0 && all.hits[1].weight > 0) {
    Vec2d const squares = displacement_error2(of, scramblings, all);
    double const excess2 = (squares.x + squares.y) / (2 * truth_tolerance_px * truth_tolerance_px);
    if (excess2 > 1) ask(by_rule ? 4 * rays : rays * sqrt(excess2));
  }
  for (int frame = 0; goal.level > 0 && frame < frame_count; ++frame) {
    CentroidSum<double> const& hits = all.hits[frame];
    double const light = hits.weight * light_per_weight;
    if (!(light > 0)) continue;
    Vec2d const mean = hits.mean();
    double const square = (hits.second.x + hits.second.y) / hits.weight - dot(mean, mean);
    double const spread2 = square > 0 ? 0.5 * square : 0.0;
    double const allowed = goal.allowed(goal.peak(light, spread2));
    ask(rays_for_spread(goal, sent, light, spread2, rays));
    if (by_rule && rays < 64) {
      double const apart = spread2 - rim.spread2[frame], left = (rays < 16 ? 1.0 : 0.25) * (apart < 0 ? -apart : apart);
      if (0.4 * left / (goal.spot2 + spread2) > allowed) ask(4 * rays);
    }
    if (scramblings == 1) continue;
    double squares = 0;
    for (int i = 0; i < scramblings; ++i) {
      double const apart = of[i].hits[frame].weight - hits.weight / scramblings;
      squares += apart * apart;
    }
    // rms over lit pixels is 0.4 to 0.7 of the peak
    double const excess = 0.7 * sqrt(error2_factor(scramblings) * squares) / (hits.weight * allowed);
    if (excess > 1) ask(by_rule ? 4 * rays : rays * pow(excess, 1 / 1.5));
  }
  return asked;
}

}  // namespace gladstone
