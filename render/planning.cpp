#include "render/planning.h"

#include <algorithm>

#include "render/focused_dots/table_error.h"
#include "render/method.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/scene/ray_budget.h"
#include "render/scene/side_faces.h"
#include "render/scene/two_media.h"

namespace gladstone {

namespace {

IntegrationStep choose_step(Scene const& scene) {
  if (!scene.second_medium) return determine_step_by_tracing(scene);
  IntegrationStep const a = choose_step(select_first_pulse(scene)), b = choose_step(select_second_pulse(scene));
  IntegrationStep finer = b.step_mm < a.step_mm ? b : a;
  finer.largest_shift = std::max(a.largest_shift, b.largest_shift);
  return finer;
}

/// Returns true if "auto" traces a given number of rays because this is estimated to take far less time than the
/// deflection table alone, whose cost does not depend on the number of dots.
bool rays_take_far_less_time(Scene const& scene, RenderPlan const& plan) {
  constexpr double long_s = 5, far_less = 60;
  if (scene.setup.render.method != RenderMethod::automatic || !plan.given_rays) return false;
  double const by_table = table_seconds(require_focused_dots(scene, plan));
  return by_table >= long_s && far_less * static_cast<double>(*plan.given_rays) * rays_seconds(scene, plan) < by_table;
}

}  // namespace

RenderPlan plan_step(Scene const& scene) { return with_step(scene, choose_step(scene)); }

RenderPlan plan_rays(Scene const& scene, RenderPlan const& stepped) {
  if (scene.second_medium) {  // use the larger number of rays of both media
    RenderPlan const a = plan_rays(select_first_pulse(scene), stepped);
    RenderPlan const b = plan_rays(select_second_pulse(scene), stepped);
    return b.rays > a.rays ? b : a;
  }
  RenderPlan plan = stepped;
  plan.method = resolve_render_method(scene);
  if (plan.method == RenderMethod::focused_dots && rays_take_far_less_time(scene, plan)) {
    plan.method = RenderMethod::rays;
  }
  if (plan.method == RenderMethod::formula) return plan;  // no rays are traced; the recorded number is one
  if (plan.method == RenderMethod::rays) return plan_rays_by_tracing(scene, plan);
  plan = plan_rays_by_table(require_focused_dots(scene, plan));
  if (!plan.given_rays && !sources_at_side_faces(scene, plan, scene.dots).empty()) {
    plan.adaptive_criteria = determine_adaptive_criteria(scene, plan);
  }
  return plan;
}

RenderPlan plan_rendering(Scene const& scene, IntegrationStep const* step) {
  return plan_rays(scene, step ? with_step(scene, *step) : plan_step(scene));
}

double render_seconds(Scene const& scene, RenderPlan const& plan, RenderTheory theory) {
  RenderMethod const method = resolve_render_method(scene, plan);
  if (method == RenderMethod::formula) return 0;
  if (method == RenderMethod::focused_dots) return dots_seconds(require_focused_dots(scene, plan), theory);
  double const media = scene.second_medium ? 2 : 1;
  return media * static_cast<double>(plan.rays) * rays_seconds(scene, plan) +
         (theory == RenderTheory::yes && scene.setup.experiment().sources.on_target ? theory_seconds(scene, plan) : 0);
}

FieldMap field_in_view(Scene const& scene, RenderPlan const& plan, int spacing_px) {
  return scene.setup.has_closed_form_layout() ? map_field(scene, plan.step, spacing_px)
                                              : map_field_by_rays(scene, plan, spacing_px);
}

StrainMap strain_in_view(Scene const& scene, RenderPlan const& plan) {
  return scene.setup.has_closed_form_layout() ? map_strain(scene) : map_strain_by_rays(scene, plan);
}

}  // namespace gladstone
