#include "studies/compare/comparison_kind.h"

namespace gladstone::inline compare {
namespace {

std::vector<Vec2d> const& eq9(Comparison const& comparison) { return comparison.point.eq9_px; }
std::vector<Vec2d> const& eq9_of_cone(Comparison const& comparison) { return comparison.point.eq9_cone_px; }

std::vector<BudgetStage> stages_from_eq9(Comparison const& comparison) {
  return {{"eq9", comparison.point.eq9_px},
          {"straight", comparison.point.chief_px},
          {"eq9_cone", comparison.point.eq9_cone_px},
          {"thin_lens", comparison.thin_lens},
          {"lens", comparison.point.displacement_px}};
}

PointTruth truth_of_dots(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                         std::vector<Vec2d> const& position_px, TruthAt at) {
  PointTruth truth;
  truth.point = truth_at_points(scene, plan, renderer, position_px, at, RenderTheory::yes);
  truth.thin_lens = ideal_lens_truth(scene, plan, renderer, truth.point);
  return truth;
}

GroundTruth dot_displacements(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                              std::vector<Vec2d> const& position_px, TruthAt at) {
  return truth_at_points(scene, plan, renderer, position_px, at, RenderTheory::no);
}

bool by_rays(Scene const& /*scene*/) { return false; }

}  // namespace

constinit ComparisonKind const bos_comparison{
    .experiment = bos_experiment,
    .chain = BudgetChain::bos,
    .title = "BOS",
    .references = {{{.measures = "eq9", .name = "Eq. 9", .row = "Eq. 9", .against = "against Eq. 9", .of = eq9},
                    {.measures = "eq9_cone",
                     .name = "aperture-averaged Eq. 9",
                     .row = "aperture-averaged Eq. 9",
                     .against = "against aperture-averaged Eq. 9",
                     .of = eq9_of_cone}}},
    .theory = "Eq. 9",
    .origin = "Eq. 9",
    .bias = "by Eq. 9",
    .bias_causes = "Cone, dot, refraction, aberration and window",
    .measured = "field",
    .remedy = "geometry.z_d_mm or the magnification",
    .stages = stages_from_eq9,
    .truth = truth_of_dots,
    .displacements = dot_displacements,
    .without_rays = by_rays};

}  // namespace gladstone::inline compare
