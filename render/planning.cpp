#include "render/planning.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "render/focused_dots/table_error.h"
#include "render/method.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/scene/side_faces.h"
#include "render/scene/two_media.h"

namespace gladstone {

IntegrationStep choose_step(Scene const& scene) {
  if (!scene.second_medium) return determine_step_by_tracing(scene);
  IntegrationStep const a = choose_step(select_first_pulse(scene)), b = choose_step(select_second_pulse(scene));
  IntegrationStep plan = b.step_mm < a.step_mm ? b : a;
  plan.largest_shift = std::max(a.largest_shift, b.largest_shift);
  return plan;
}

Scene with_chosen_step(Scene scene) {
  IntegrationStep const plan = choose_step(scene);
  return with_step(std::move(scene), plan);
}

namespace {

/// Determines the rays of dots rejected by the fast renderer because of the field's side faces. If their number is
/// given, measures the resulting errors of truth and images.
void plan_rays_at_side_faces(Scene const& scene, RayBudget& plan) {
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, scene.dots);
  if (at_faces.empty()) return;
  auto const given = scene.setup.render.rays_per_dot;
  Scene by_rays = with_bright_dots(scene, select_dots(scene.dots, at_faces), given.value_or(1));
  bool const seen = std::any_of(by_rays.dots.centre.begin(), by_rays.dots.centre.end(),
                                [&scene](Vec2d centre) { return scene.in_view(centre); });
  if (given && !seen) return;
  // upper limit of the rays per dot, so that measuring costs no more than rendering
  constexpr std::uint64_t cheap_rays = 256;
  RayBudget const at_side_faces = given ? measure_errors_by_tracing(by_rays, cheap_rays)
                                        : determine_ray_budget_by_tracing(by_rays, determine_adaptive_criteria(scene));
  if (seen) {
    plan.side_faces = {at_faces.size(), at_side_faces.rays, at_side_faces.truth_error_px,
                       at_side_faces.image_error_levels, at_side_faces.rays_wanted};
  }
  if (given) return;
  plan.adaptive_criteria = at_side_faces.adaptive_criteria;
  plan.rays_at_side_faces = at_side_faces.most;
  plan.truth_error_px = std::fmax(plan.truth_error_px, at_side_faces.truth_error_px);
  plan.image_error_levels = std::fmax(plan.image_error_levels, at_side_faces.image_error_levels);
  plan.extrapolated = at_side_faces.extrapolated;
  plan.converged = plan.converged && at_side_faces.converged;
  plan.rays_wanted = std::max(plan.rays_wanted, at_side_faces.rays_wanted);  // NaN persists
  plan.seconds += at_side_faces.seconds;
}

/// Returns a ray budget if tracing a few dots is much cheaper than the deflection table, whose cost is independent of
/// their number. Returns nullopt otherwise, or if the rays allowed by "auto" do not reach the accuracy goals.
std::optional<RayBudget> plan_cheaper_rays(Scene const& scene) {
  constexpr double long_s = 5, much_cheaper = 60;
  if (scene.setup.render.method != RenderMethod::automatic) return std::nullopt;
  double const by_table = table_seconds(require_focused_dots(scene));
  auto const given = configured_ray_budget(scene.setup);
  double const rays = static_cast<double>(given ? given->rays : max_rays_per_source(scene));
  if (by_table < long_s || much_cheaper * rays * rays_seconds(scene) > by_table) return std::nullopt;
  RayBudget plan = determine_ray_budget_by_tracing(scene);
  if (!given && plan.excess() > 1) return std::nullopt;
  plan.method = RenderMethod::rays;
  return plan;
}

/// Plans the rays of the fast renderer. With "auto", returns the plan of the general renderer if its errors are smaller
/// and those of the fast one exceed the accuracy goals.
RayBudget plan_table_or_rays(Scene const& scene) {
  constexpr std::uint64_t rivals = 4096;  // rays per dot; fewer scatter by more than the table's error
  auto const given = configured_ray_budget(scene.setup);
  RayBudget plan = determine_ray_budget(require_focused_dots(scene));
  Scene planned = scene;
  if (scene.setup.render.method == RenderMethod::automatic) {
    if (given && given->rays >= rivals) {
      planned.rays_per_dot = given->rays;
      plan = measure_table_error(require_focused_dots(planned));
    }
    plan.method = RenderMethod::focused_dots;
    if (plan.excess() > 1) {  // Compare with the general renderer.
      auto const by_rays_of = [&](Scene const& other) {
        RayBudget const by_rays = determine_ray_budget_by_tracing(other);
        return given ? measure_errors_by_tracing(with_rays(other, by_rays)) : by_rays;
      };
      // Use the same dots for both, so that the choice does not depend on the sample.
      Scene const sample = with_bright_dots(planned, measured_places(planned), planned.rays_per_dot);
      if (by_rays_of(sample).excess() < plan.excess()) {
        plan = by_rays_of(planned);
        plan.method = RenderMethod::rays;
        return plan;
      }
    }
  }
  planned.rays_per_dot = plan.rays;
  if (plan.method != RenderMethod::automatic) planned.setup.render.method = plan.method;
  plan_rays_at_side_faces(planned, plan);
  return plan;
}

}  // namespace

RayBudget choose_ray_budget(Scene const& scene) {
  if (scene.second_medium) {  // use the larger number of rays of both media
    RayBudget const a = choose_ray_budget(select_first_pulse(scene)), b = choose_ray_budget(select_second_pulse(scene));
    return b.rays > a.rays ? b : a;
  }
  if (resolve_render_method(scene) == RenderMethod::formula) {  // no rays are traced; the recorded number is one
    RayBudget plan;
    plan.rays = 1;
    plan.bits = scene.setup.camera.bit_depth;
    return plan;
  }
  if (resolve_render_method(scene) == RenderMethod::rays) return determine_ray_budget_by_tracing(scene);
  if (auto const cheaper = plan_cheaper_rays(scene)) return *cheaper;
  return plan_table_or_rays(scene);
}

double render_seconds(Scene const& scene, RayBudget const& plan, RenderTheory theory) {
  RenderMethod const method = resolve_render_method(scene);
  if (method == RenderMethod::formula) return 0;
  if (method == RenderMethod::focused_dots) return dots_seconds(require_focused_dots(scene), theory);
  double const media = scene.second_medium ? 2 : 1;
  double const rays = std::isfinite(plan.seconds) ? plan.seconds : static_cast<double>(plan.rays) * rays_seconds(scene);
  return media * rays + (theory == RenderTheory::yes && !scene.setup.piv ? theory_seconds(scene) : 0);
}

FieldMap field_in_view(Scene const& scene, int spacing_px) {
  return scene.setup.has_closed_form_layout() ? map_field(scene, spacing_px) : map_field_by_rays(scene, spacing_px);
}

StrainMap strain_in_view(Scene const& scene) {
  return scene.setup.has_closed_form_layout() ? map_strain(scene) : map_strain_by_rays(scene);
}

}  // namespace gladstone
