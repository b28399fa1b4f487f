#pragma once

#include <span>
#include <vector>

#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/correlation/window_measurement.h"
#include "render/base/host_device.h"

/// Additional passes for steep displacement gradients. A window in which the displacement varies by more than a
/// particle diameter has no single correlation peak. Next to it are windows in a weaker gradient, which were measured.
/// Their vectors are extrapolated to this window and its images are deformed accordingly, which removes most of the
/// gradient, so that a single peak appears (iterative image deformation, Scarano, Meas. Sci. Technol. 13 (2002) R1;
/// Schrijer & Scarano, Exp. Fluids 45 (2008) 927, for the stability of the iterations with filtered predictors). Each
/// additional pass proceeds by one ring of windows further into the gradient. The additional passes also reduce the
/// damping of displacement waves that are hardly longer than the window.
namespace gladstone::inline correlation {

/// Displacement gradient from which vectors are refined [px/px]: a Gaussian window of 20 px (standard deviation 8 px)
/// then contains displacements that differ by half a particle diameter. The fields for which the default passes are
/// designed (vortices, refraction) have weaker gradients.
constexpr double steep_gradient = 0.1;

/// Thresholds of mismatched vectors: a vector is mismatched if its correlation is below this fraction of the highest
/// correlation within two windows. The additional passes use the first and the second value alternately. Wrong vectors
/// correlate with 0.2 to 0.4, or up to 0.6 near the border of the image, where a few particles agree by chance. Correct
/// vectors within a gradient correlate with 0.5 or more, their neighbours with more than 0.9. No single fraction
/// separates correct from wrong vectors: the higher fraction finds more wrong vectors, the lower one retains more
/// correct vectors for the extrapolation. Vectors that correlate worse afterwards are not replaced.
constexpr double min_fractions_of_best_correlation[] = {0.7, 0.5};

/// Minimum ratio of a refined vector's correlation to its correlation before the refinement. The ratio is slightly
/// below 1, because a predictor that is too smooth may increase the correlation by chance.
constexpr double min_fraction_of_earlier_correlation = 0.98;

/// Change of the vectors below which the refinement ends [px]; the largest change is at least halved by each pass.
constexpr double negligible_refinement_px = 0.02;

/// Minimum correlation that one of two neighbouring vectors must have for their difference to count as a gradient. In
/// frames with strong noise or many lost particle pairs, no vector has this correlation, and differences between
/// neighbours are errors. In frames of good quality, the correct vectors next to a wrong one have at least this
/// correlation.
constexpr double min_correlation_of_match = 0.8;

/// Returns whether the displacements a and b of two neighbours differ by a steep gradient.
GLADSTONE_HD inline bool is_steep(Vec2d a, Vec2d b, double correlation_a, double correlation_b,
                                  InterrogationGrid const& grid) {
  return (correlation_a >= min_correlation_of_match || correlation_b >= min_correlation_of_match) &&
         length(b - a) > steep_gradient * grid.spacing_px;
}

/// Returns whether the gradient from vector i to its right or lower neighbour is steep; vectors that are neither valid
/// nor replaced are ignored.
GLADSTONE_HD inline bool is_steep(GridVector const* vectors, int i, InterrogationGrid const& grid) {
  auto const differs = [&](bool exists, int k) {
    return exists && is_valid_or_replaced(vectors[k].status) &&
           is_steep(vectors[i].displacement, vectors[k].displacement, vectors[i].correlation, vectors[k].correlation,
                    grid);
  };
  return is_valid_or_replaced(vectors[i].status) && (differs(i % grid.columns + 1 < grid.columns, i + 1) ||
                                                     differs(i / grid.columns + 1 < grid.rows, i + grid.columns));
}

/// Returns whether any gradient between neighbouring vectors of a grid is steep.
bool has_steep_gradient(std::span<GridVector const> vectors, InterrogationGrid const& grid);

/// Predictor of an additional pass and the vectors that it may change.
struct RefinementPlan {
  std::vector<Vec2d> nodes;      ///< displacement at every window before smoothing [px]
  std::vector<char> wanted;      ///< 1: the vector is at most the width of a window away from a steep gradient
  std::vector<char> mismatched;  ///< 1: the vector is mismatched, and its node was extrapolated from other nodes
  /// 1: the vector remains ambiguous; mismatched vectors lose this mark, because they are measured again.
  std::vector<char> ambiguous;
};

/// Validated vectors of a pass, with the correlation results of their windows.
struct RefinedPass {
  std::vector<GridVector> vectors;
  std::vector<WindowCorrelation> windows;
};

/// Finds mismatched vectors and replaces their nodes by extrapolation: from the border of each group inwards, each node
/// is the value of the least-squares plane through the known nodes up to two steps away, weighted by the inverse square
/// of their distance.
/// @param min_fraction  one of min_fractions_of_best_correlation
RefinementPlan plan_refinement(std::span<GridVector const> vectors, InterrogationGrid const& grid, double min_fraction);

/// Replaces vectors near steep gradients (RefinementPlan::wanted) by those of an additional pass, where these correlate
/// about as well as before or better. A mismatched vector whose extrapolated displacement leads out of the frames
/// cannot be measured: it is rejected, and replaced by that displacement if the rule allows it.
/// @param pass  input: vectors and windows before the replacement; output: after the replacement @return largest change
///             of a measured displacement [px]
double take_refined(RefinedPass& pass, RefinedPass const& refined, RefinementPlan const& plan,
                    ValidationRule const& rule);

/// Refines the vectors of the last pass by up to `most_passes` additional passes. @pre some gradient is steep
/// @param rule  validation rule of the last pass
/// @param measure  measure(plan) deforms the original frames by the smoothed nodes of a plan and returns a RefinedPass
template <class Measure>
void refine_steep_vectors(RefinedPass& pass, InterrogationGrid const& grid, int most_passes, ValidationRule const& rule,
                          Measure const& measure) {
  for (int k = 0; k < most_passes; ++k) {
    RefinementPlan const plan = plan_refinement(pass.vectors, grid, min_fractions_of_best_correlation[k % 2]);
    if (take_refined(pass, measure(plan), plan, rule) <= negligible_refinement_px) return;
  }
}

}  // namespace gladstone::inline correlation
