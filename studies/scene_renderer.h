#pragma once

#include <memory>
#include <string>

#include "render/scene/field_map.h"
#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// The method that renders a scene: rays or focused_dots, never automatic.
RenderMethod method_of(Scene const& scene);

/// "rays" or "focused_dots", as files call it.
char const* to_string(RenderMethod method);

/// Renders every scene by its method, on one device. Dots that the fast renderer leaves, at a side face of the medium
/// or where their rays get lost, go ray by ray all the same, and by a number of rays of their own.
class SceneRenderer : public Renderer {
 public:
  /// @param focused_dots,rays the renderers of that device
  SceneRenderer(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays);

  std::string device() const override { return rays_->device(); }
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;
  Rendering render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                             RenderImages images) override;

 private:
  /// Renders particles whose light can reach the sensor; the others have no truth and no planned rays.
  Rendering render_near_view(Scene& scene, Particles const& particles, RenderImages images);
  Rendering render_focused(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory);

  std::unique_ptr<Renderer> focused_dots_, rays_;
};

/// What plans a scene and maps its field, by its method.
StepPlan plan_step_of(Scene& scene);
/// With "auto" the method, too: the fast renderer where what its table leaves is within what "auto" asks of truth and
/// images, or less than what the general renderer's rays would scatter by; but rays where a table takes 60 times
/// their processor time and more than 5 s of it, and they are given, or good enough. Sets scene.setup.render.method
/// then.
RaysPlan plan_rays_of(Scene& scene);
/// Processor time that rendering a planned scene takes [s], as ray_seconds() counts it.
double render_seconds(Scene const& scene, RaysPlan const& plan);
FieldMap field_of(Scene const& scene, int spacing_px);
StrainMap strain_of(Scene const& scene);

}  // namespace gladstone
