#pragma once

#include "render/focused_dots/cone_moments.h"
#include "render/focused_dots/trace_pair.h"
#include "render/light/sources.h"
#include "render/scene/ground_truth.h"

/// Standard errors of a dot's displacement, from the scatter between the independent scramblings of its rays.
namespace gladstone {

/// What some of a dot's rays come to.
struct RaySums {
  CentroidSum<double> hits[frame_count];
  TableCheck check;  ///< where the deflection table covers the dot

  GLADSTONE_HD RaySums& operator+=(RaySums const& o) {
    for (int frame = 0; frame < frame_count; ++frame) hits[frame] += o.hits[frame];
    check += o.check;
    return *this;
  }
};

/// Squares of standard errors, by component [px^2].
struct TruthErrors {
  Vec2d rays2;   ///< of the difference of the rays' centroids
  Vec2d table2;  ///< of the integral over the cone that the rays correct: what their choice makes of it
  Vec2d miss2;   ///< variance from ray to ray of what the table is off by
};

/// Student's quantile for `scramblings` - 1 degrees of freedom that 68.27 % lie within: widens an error that so few
/// numbers tell.
GLADSTONE_HD inline double student_factor(int scramblings) {
  return scramblings >= 8 ? 1.077 : (scramblings >= 4 ? 1.197 : 1.837);
}

/// Errors of ratios of sums over groups, each linearised about the whole (Cochran, Sampling Techniques, 1977, section
/// 6.3): a group moves a ratio by its own excess over the whole's. All of them together move it by nothing, so that the
/// variance of the ratio is n / (n - 1) times the sum of the n groups' squares. NaN for a single group.
/// @param of each scrambling @param all their sum
GLADSTONE_HD inline TruthErrors truth_errors(RaySums const* of, int scramblings, RaySums const& all) {
  auto const square = [](Vec2d v) { return Vec2d{v.x * v.x, v.y * v.y}; };
  CentroidSum<double> const &reference = all.hits[0], &flow = all.hits[1];
  TableCheck const& check = all.check;
  Vec2d const in_reference = reference.mean(), in_flow = flow.mean();
  Vec2d const miss = (check.traced - check.expected) / check.weight;
  Vec2d rays2{}, table2{};
  for (int i = 0; i < scramblings; ++i) {
    RaySums const& here = of[i];
    rays2 += square((here.hits[1].first - here.hits[1].weight * in_flow) / flow.weight -
                    (here.hits[0].first - here.hits[0].weight * in_reference) / reference.weight);
    table2 += square((here.check.traced - here.check.expected - here.check.weight * miss) / check.weight);
  }
  double const factor = student_factor(scramblings), scale = factor * factor * scramblings / (scramblings - 1.0);
  // the stop's smoothed edge lets some weights be negative, and so a variance of little but these
  Vec2d const miss2 = check.miss2 / check.weight - square(miss);
  return {scale * rays2, scale * table2, {miss2.x > 0 ? miss2.x : 0, miss2.y > 0 ? miss2.y : 0}};
}

}  // namespace gladstone
