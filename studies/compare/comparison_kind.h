#pragma once

#include <array>
#include <vector>

#include "render/scene/experiment.h"
#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Reference displacement, in addition to the ray truth, with which vectors are compared.
struct ReferenceDisplacement {
  char const* measures;  ///< key of its error measures in errors.json
  char const* name;      ///< name in figures and tables
  char const* row;       ///< name of the row in the report on the terminal
  char const* against;   ///< name of the difference between measurement and reference
  std::vector<Vec2d> const& (*of)(Comparison const& comparison);
};

/// Kind of comparison: references and words for the vectors of one experiment.
struct ComparisonKind {
  Experiment const& experiment;
  BudgetChain chain;
  char const* title;  ///< name of the experiment as it appears in sentences
  /// References of the comparison; the first one is the theory, with which the error budget begins.
  std::array<ReferenceDisplacement, 2> references;
  char const* theory;       ///< name of the theory, as it follows "against" in a sentence
  char const* origin;       ///< first stage of the error budget, as it follows "from" in a sentence
  char const* bias;         ///< "the displacement ..."
  char const* bias_causes;  ///< causes of the difference between true displacement and theory
  char const* measured;     ///< quantity that can be determined from the displacement
  char const* remedy;       ///< keys that increase the displacement
  /// Returns the stages of the budget from the theory to the ray truth.
  std::vector<BudgetStage> (*stages)(Comparison const& comparison);
  /// Computes truth and theory at points of the image, see truth_of_vectors().
  PointTruth (*truth)(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                      std::vector<Vec2d> const& position_px, TruthAt at);
  /// Computes the true displacements alone.
  GroundTruth (*displacements)(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                               std::vector<Vec2d> const& position_px, TruthAt at);
  /// Returns true if the true displacements require no rays.
  bool (*without_rays)(Scene const& scene);
};

extern ComparisonKind const bos_comparison, piv_comparison;

/// All kinds of comparison, the default first. To add one, write its file in studies/compare/kinds/ and add its name
/// above and here.
inline constexpr std::array all_comparison_kinds{&bos_comparison, &piv_comparison};

ComparisonKind const& comparison_kind(Setup const& setup);
ComparisonKind const& comparison_kind(Comparison const& comparison);

}  // namespace gladstone::inline compare
