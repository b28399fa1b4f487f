#include "studies/scene_renderer.h"

#include <spdlog/spdlog.h>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/focused_dots/dot_planning.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/rays/rays_renderer.h"

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

SceneRenderer::SceneRenderer(std::unique_ptr<Renderer> device, bool only)
    : device_(std::move(device)), rays_(std::make_unique<RaysRenderer>()), only_(only) {}

Rendering SceneRenderer::render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) {
  RenderMethod const method = method_of(scene);
  bool const other_device = device_->device() != rays_->device();
  bool const on_device = method == RenderMethod::focused_dots || (other_device && scene.setup.on_bench() &&
                                                                  scene.setup.render.method == RenderMethod::automatic);
  if (!on_device && other_device) {
    std::string const reason = reason_against_focused_dots(scene.setup);
    std::string const why = reason.empty() ? "render.method = \"rays\"" : reason;
    if (only_) {
      throw DeviceError("--device " + device_->device() + ": the general renderer, which this scene needs (" + why +
                        "), runs on the CPU; use --device cpu or auto");
    }
    if (!told_) spdlog::info("method: rays ({}), on the CPU", why);
    told_ = true;
  }
  Renderer& renderer = on_device ? *device_ : *rays_;
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
