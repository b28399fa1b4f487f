#pragma once

#include "render/scene/ground_truth.h"
#include "render/scene/ray_hit.h"

/// Standard errors of a source's displacement, from the scatter between independent scramblings of its rays.
namespace gladstone::inline scene {

/// Sums over a subset of a source's rays, for both images.
struct RaySums {
  CentroidSum<double> hits[frame_count];

  GLADSTONE_HD RaySums& operator+=(RaySums const& o) {
    for (int frame = 0; frame < frame_count; ++frame) hits[frame] += o.hits[frame];
    return *this;
  }
};

/// Returns Student's t quantile of the central 68.27 % interval for `scramblings` - 1 degrees of freedom, which widens
/// a standard error estimated from so few values.
GLADSTONE_HD inline double student_factor(int scramblings) {
  return scramblings >= 8 ? 1.077 : (scramblings >= 4 ? 1.197 : 1.837);
}
/// Returns the factor from a sum of squared contributions of the scramblings to a squared standard error; infinite for
/// one scrambling.
GLADSTONE_HD inline double error2_factor(int scramblings) {
  double const factor = student_factor(scramblings);
  return factor * factor * scramblings / (scramblings - 1.0);
}
GLADSTONE_HD inline Vec2d squares_of(Vec2d v) { return {v.x * v.x, v.y * v.y}; }

/// Computes the squared standard error of the difference of two centroids, by component [px^2].
/// A centroid is a ratio of sums over groups (scramblings), linearised about the total (Cochran, Sampling Techniques,
/// 1977, section 6.3): each group contributes its deviation from the total ratio. The deviations sum to zero, so the
/// variance is n / (n - 1) times the sum of their squares over the n groups, widened by student_factor(). NaN for a
/// single group.
/// @param of  sums of each scrambling
/// @param all  sum over all scramblings
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

}  // namespace gladstone::inline scene
