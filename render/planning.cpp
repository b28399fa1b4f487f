#include "render/planning.h"

#include <algorithm>
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
  IntegrationStep finer = b.step_mm < a.step_mm ? b : a;
  finer.largest_shift = std::max(a.largest_shift, b.largest_shift);
  return finer;
}

Scene with_chosen_step(Scene scene) {
  IntegrationStep const step = choose_step(scene);
  return with_step(std::move(scene), step);
}

namespace {

/// Returns true if "auto" traces a given number of rays because this is estimated to take far less time than the
/// deflection table alone, whose cost does not depend on the number of dots.
bool rays_take_far_less_time(Scene const& scene) {
  constexpr double long_s = 5, far_less = 60;
  auto const rays = scene.setup.render.rays_per_dot;
  if (scene.setup.render.method != RenderMethod::automatic || !rays) return false;
  double const by_table = table_seconds(require_focused_dots(scene));
  return by_table >= long_s && far_less * static_cast<double>(*rays) * rays_seconds(scene) < by_table;
}

}  // namespace

RayBudget choose_ray_budget(Scene const& scene) {
  if (scene.second_medium) {  // use the larger number of rays of both media
    RayBudget const a = choose_ray_budget(select_first_pulse(scene)), b = choose_ray_budget(select_second_pulse(scene));
    return b.rays > a.rays ? b : a;
  }
  RenderMethod const method = resolve_render_method(scene);
  if (method == RenderMethod::formula) return {};  // no rays are traced; files state the default number of rays, one
  if (method == RenderMethod::rays) return determine_ray_budget_by_tracing(scene);
  if (rays_take_far_less_time(scene)) {
    RayBudget budget = determine_ray_budget_by_tracing(scene);
    budget.method = RenderMethod::rays;
    return budget;
  }
  RayBudget budget = determine_ray_budget(require_focused_dots(scene));
  budget.method = RenderMethod::focused_dots;
  if (!scene.setup.render.rays_per_dot && !sources_at_side_faces(scene, scene.dots).empty()) {
    budget.adaptive_criteria = determine_adaptive_criteria(scene);
  }
  return budget;
}

double render_seconds(Scene const& scene, RenderTheory theory) {
  RenderMethod const method = resolve_render_method(scene);
  if (method == RenderMethod::formula) return 0;
  if (method == RenderMethod::focused_dots) return dots_seconds(require_focused_dots(scene), theory);
  double const media = scene.second_medium ? 2 : 1;
  return media * static_cast<double>(scene.rays_per_dot) * rays_seconds(scene) +
         (theory == RenderTheory::yes && scene.setup.experiment().sources.on_target ? theory_seconds(scene) : 0);
}

FieldMap field_in_view(Scene const& scene, int spacing_px) {
  return scene.setup.has_closed_form_layout() ? map_field(scene, spacing_px) : map_field_by_rays(scene, spacing_px);
}

StrainMap strain_in_view(Scene const& scene) {
  return scene.setup.has_closed_form_layout() ? map_strain(scene) : map_strain_by_rays(scene);
}

}  // namespace gladstone
