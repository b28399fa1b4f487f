#include "studies/scene_renderer.h"

#include "render/base/contracts.h"
#include "render/focused_dots/dot_planning.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"

namespace gladstone {
namespace {

FocusedDots enter(Scene const& scene) {
  std::optional<FocusedDots> const dots = focused_dots(scene);
  GLADSTONE_EXPECTS(dots);
  return *dots;
}

}  // namespace

RenderMethod method_of(Scene const& scene) {
  RenderMethod const wanted = scene.setup.render.method;
  if (wanted != RenderMethod::automatic) return wanted;
  return focused_dots(scene) ? RenderMethod::focused_dots : RenderMethod::rays;
}

char const* to_string(RenderMethod method) { return method == RenderMethod::focused_dots ? "focused_dots" : "rays"; }

SceneRenderer::SceneRenderer(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays)
    : focused_dots_(std::move(focused_dots)), rays_(std::move(rays)) {}

Rendering SceneRenderer::render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) {
  RenderMethod const method = method_of(scene);
  Renderer& renderer = method == RenderMethod::focused_dots ? *focused_dots_ : *rays_;
  Rendering rendering = renderer.render(scene, sources, images, theory);
  rendering.method = method;
  rendering.device = renderer.device();
  return rendering;
}

StepPlan plan_step_of(Scene& scene) {
  if (method_of(scene) == RenderMethod::rays) return plan_step_by_rays(scene);
  StepPlan const plan = plan_step(enter(scene));
  use_step(scene, plan);
  return plan;
}

RaysPlan plan_rays_of(Scene& scene) {
  if (method_of(scene) == RenderMethod::rays) return plan_rays_by_rays(scene);
  RaysPlan const plan = plan_rays(enter(scene));
  scene.rays_per_dot = plan.rays;
  return plan;
}

FieldMap field_of(Scene const& scene, int spacing_px) {
  return scene.setup.on_bench() ? map_field(scene, spacing_px) : map_field_by_rays(scene, spacing_px);
}

StrainMap strain_of(Scene const& scene) {
  return scene.setup.on_bench() ? map_strain(scene) : map_strain_by_rays(scene);
}

}  // namespace gladstone
