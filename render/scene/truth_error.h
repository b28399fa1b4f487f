#pragma once

#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"

/// Standard errors of a source's displacement, from the scatter between the independent scramblings of its rays.
namespace gladstone {

/// What some of a source's rays come to.
struct RaySums {
  CentroidSum<double> hits[frame_count];

  GLADSTONE_HD RaySums& operator+=(RaySums const& o) {
    for (int frame = 0; frame < frame_count; ++frame) hits[frame] += o.hits[frame];
    return *this;
  }
};

/// Student's quantile for `scramblings` - 1 degrees of freedom that 68.27 % lie within: widens an error that so few
/// numbers tell.
GLADSTONE_HD inline double student_factor(int scramblings) {
  return scramblings >= 8 ? 1.077 : (scramblings >= 4 ? 1.197 : 1.837);
}
/// What makes the sum of the scramblings' squares the square of a standard error; infinite for a single one.
GLADSTONE_HD inline double error2_factor(int scramblings) {
  double const factor = student_factor(scramblings);
  return factor * factor * scramblings / (scramblings - 1.0);
}
GLADSTONE_HD inline Vec2d squares_of(Vec2d v) { return {v.x * v.x, v.y * v.y}; }

/// Square of the standard error of the difference of the rays' centroids, by component [px^2]. They are ratios of sums
/// over groups, each linearised about the whole (Cochran, Sampling Techniques, 1977, section
/// 6.3): a group moves a ratio by its own excess over the whole's. All of them together move it by nothing, so that the
/// variance of the ratio is n / (n - 1) times the sum of the n groups' squares. NaN for a single group.
/// @param of each scrambling @param all their sum
template <class Sums>
GLADSTONE_HD Vec2d displacement_error2(Sums const* of, int scramblings, Sums const& all) {
  CentroidSum<double> const &reference = all.hits[0], &flow = all.hits[1];
  Vec2d const in_reference = reference.mean(), in_flow = flow.mean();
  Vec2d squares{};
  for (int i = 0; i < scramblings; ++i) {
    Sums const& here = of[i];
    squares += squares_of((here.hits[1].first - here.hits[1].weight * in_flow) / flow.weight -
                          (here.hits[0].first - here.hits[0].weight * in_reference) / reference.weight);
  }
  return error2_factor(scramblings) * squares;
}

}  // namespace gladstone
