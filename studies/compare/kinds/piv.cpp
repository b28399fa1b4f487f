#include "studies/compare/comparison_kind.h"
#include "studies/compare/particle_points.h"

namespace gladstone::inline compare {
namespace {

std::vector<Vec2d> const& flow(Comparison const& comparison) { return comparison.flow_px; }
std::vector<Vec2d> const& without_medium(Comparison const& comparison) { return comparison.ambient_px; }

std::vector<BudgetStage> stages_from_flow(Comparison const& comparison) {
  return {{"flow", comparison.flow_px}, {"ambient", comparison.ambient_px}, {"seen", comparison.point.displacement_px}};
}

PointTruth truth_of_particles(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                              std::vector<Vec2d> const& position_px, TruthAt at) {
  ParticlePoints points = particle_points(scene, plan, renderer, position_px, at);
  return {std::move(points.seen), {}, std::move(points.flow_px), std::move(points.ambient_px)};
}

}  // namespace

constinit ComparisonKind const piv_comparison{
    .experiment = piv_experiment,
    .chain = BudgetChain::piv,
    .title = "PIV",
    .references = {{{.measures = "flow", .name = "flow", .row = "flow", .against = "against the flow", .of = flow},
                    {.measures = "ambient_truth",
                     .name = "without medium",
                     .row = "ray truth without medium",
                     .against = "against truth without medium",
                     .of = without_medium}}},
    .theory = "the displacement of the flow",
    .origin = "the flow",
    .bias = "of the flow",
    .bias_causes = "Medium, imaging and window",
    .measured = "flow",
    .remedy = "flow.dt_us or the magnification",
    .stages = stages_from_flow,
    .truth = truth_of_particles,
    .displacements = particle_displacements,
    .without_rays = has_projected_displacements};

}  // namespace gladstone::inline compare
