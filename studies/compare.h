#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/error_budget.h"
#include "analysis/error_summary.h"
#include "analysis/vector_file.h"
#include "analysis/window_truth.h"
#include "render/scene/renderer.h"
#include "studies/case.h"
#include "studies/device.h"

namespace gladstone {

/// How a comparison is to be made.
struct CompareOptions {
  std::string vectors;  ///< file; empty: CASE/vectors.h5
  TruthAt truth_at = TruthAt::mid_position;
  std::optional<std::string> conventions;  ///< as the user tells them; empty: detected for foreign files
  bool figures = true;
};

/// Everything that is known at every vector: the chain from Eq. 9 to the measurement.
struct Comparison {
  DisplacementField measured;
  GroundTruth point;             ///< truth and theory of the virtual dot whose place the vector is
  std::vector<Vec2d> thin_lens;  ///< of the same virtual dots as an ideal lens focused on the target sees them
  WindowTruth window;
  std::vector<Vec2d> noise_free;  ///< measured on noise-free, unquantised images; empty for foreign vectors
  std::vector<double> strain;     ///< largest of Eq. 9 on each vector's window [px/px]
  VectorMask mask;
  ErrorBudget budget;
  std::string report;  ///< what was detected about a foreign file; empty for ours
  bool foreign = false;
};

/// Virtual dots of the target's size whose mid-position (or reference position) is each of `centres_px`: two rounds of
/// correction with few rays, then the truth and theory there with all of them.
GroundTruth truth_at_points(Scene& scene, Renderer& renderer, std::vector<Vec2d> const& centres_px, TruthAt at,
                            RenderTheory theory);

/// Displacements of those virtual dots through an ideal thin lens that images the target sharply at the scene's own
/// magnification, with the same rays and the same stop: where a ray ends is where it seems to come from on the target.
/// What the actual lens adds, defocus included, is the budget's aberration.
std::vector<Vec2d> ideal_lens_truth(Scene scene, Renderer& renderer, GroundTruth const& point);

/// Compares the vectors of a CASE with its truth and theory, rendering again what the comparison needs.
Comparison compare_case(std::string const& folder, Device const& device, CompareOptions const& options);

/// errors.json: for each of ray_truth, eq9, eq9_cone and window_truth the measures, and the budget.
std::string errors_json(Comparison const& comparison);

/// Mask of the vectors whose local strain is at most `limit`.
VectorMask gentle_mask(Comparison const& comparison, double limit);

/// Draws displacement maps, histograms, error against gradient and the budget into the CASE. @return their paths
std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison);

}  // namespace gladstone
