#include "studies/case/render_cost.h"

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/focused_dots/focused_dots.h"
#include "render/focused_dots/table_error.h"
#include "render/method.h"
#include "render/planning.h"
#include "render/scene/build_camera.h"
#include "render/scene/calibration_planes.h"
#include "render/scene/ray_budget.h"
#include "studies/case/case_kind.h"

namespace gladstone::inline cases {
namespace {

/// Returns a medium in which rays need as many steps as in that of a setup, without reading a field.
BuiltMedium stand_in_medium(MediumSetup setup) {
  if (setup.field.kind != FieldKind::file) return build_medium(setup);
  Bounds<double> const box = file_bounds(setup);
  double const steps = steps_across(setup), finest = finest_length(setup);
  setup.thickness = box.high.z - box.low.z;
  setup.field = FieldSetup(UniformGradient<double>{});
  BuiltMedium medium = build_medium(setup);
  medium.finest = finest;
  medium.coarsest_step = setup.thickness / steps;
  return medium;
}

/// Builds a scene with the dots of a target, but without particles.
Scene cost_scene(Setup const& setup) {
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  if (setup.experiment().sources.on_target) scene.dots = build_target(setup);
  scene.medium = stand_in_medium(setup.medium);
  if (setup.medium.second_field) scene.second_medium = stand_in_medium(select_second_pulse(setup.medium));
  return scene;
}

/// Returns the processor time of `gladstone render` relative to that of render_seconds(), which adds up the times of
/// single operations: about the geometric mean of six setups with a table of deflections of a file, three of a closed
/// form, and three ray by ray (docs/performance.md).
double measured_share(Setup const& setup, RenderMethod method) {
  constexpr double rays = 1.5, table_of_file = 0.3, table_of_closed_form = 1.3;
  if (method != RenderMethod::focused_dots) return rays;
  return setup.medium.field.kind == FieldKind::file ? table_of_file : table_of_closed_form;
}

}  // namespace

double RenderCost::seconds() const { return expected_seconds / thread_count(); }
double RenderCost::longest_seconds() const { return processor_seconds / thread_count(); }

double RenderCost::bytes() const {
  double sum = 0;
  for (MemoryRequirement const& part : memory) sum += part.bytes;
  return sum;
}

RenderCost estimate_render_cost(Setup const& setup) {
  CaseKind const& kind = case_kind(setup);
  bool const one_frame_per_plane = !setup.experiment().correlated;
  RenderCost cost;
  cost.memory = memory_requirements(setup);
  Scene const scene = cost_scene(one_frame_per_plane ? plane_setup(setup, setup.planes.front()) : setup);
  RenderPlan plan;
  plan.given_rays = setup.render.rays_per_dot;
  plan.step = setup.medium.step_mm ? *setup.medium.step_mm * unit::millimetre : scene.medium.coarsest_step;
  plan.method = cost.method = resolve_render_method(scene);
  double const images = one_frame_per_plane ? static_cast<double>(setup.planes.size()) : 1;
  cost.sources = images * kind.expected_sources(scene);
  if (cost.method == RenderMethod::formula) return cost;
  bool const by_table = cost.method == RenderMethod::focused_dots, chief = scene.chief_rays_only();
  if (by_table) {
    std::vector<MemoryRequirement> const table = focused_dots_memory(setup);
    cost.memory.insert(cost.memory.end(), table.begin(), table.end());
  }
  cost.rays_are_largest = !plan.given_rays && !by_table && !chief;
  std::uint64_t const automatic = chief ? 1 : by_table ? initial_table_rays : max_rays_per_source(scene, plan);
  plan.rays = plan.given_rays.value_or(automatic);
  cost.rays_per_source = cost.expected_rays = static_cast<double>(plan.rays);
  if (kind.expected_rays) {
    double const media = scene.second_medium ? 2 : 1;
    cost.processor_seconds = media * cost.sources * cost.rays_per_source * ray_seconds(scene, plan);
    if (cost.rays_are_largest) cost.expected_rays = kind.expected_rays(setup, cost.rays_per_source);
  } else if (by_table && !build_focused_dots(scene)) {  // rendering would refuse the setup and state the reason
    cost.processor_seconds = not_measured;
  } else {
    cost.processor_seconds =
        images * render_seconds(scene, plan, one_frame_per_plane ? RenderTheory::no : RenderTheory::yes);
  }
  cost.processor_seconds *= measured_share(setup, cost.method);
  cost.expected_seconds = cost.processor_seconds * cost.expected_rays / cost.rays_per_source;
  return cost;
}

double expected_render_seconds(Scene const& scene, RenderPlan const& plan, RenderTheory theory) {
  double const longest =
      measured_share(scene.setup, resolve_render_method(scene, plan)) * render_seconds(scene, plan, theory);
  auto const expected_rays = case_kind(scene.setup).expected_rays;
  if (!expected_rays || !plan.adaptive_criteria) return longest;
  auto const most = static_cast<double>(plan.rays);
  return longest * expected_rays(scene.setup, most) / most;
}

}  // namespace gladstone::inline cases
