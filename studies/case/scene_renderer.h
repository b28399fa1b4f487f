#pragma once

#include <memory>
#include <string>

#include "render/scene/field_map.h"
#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Returns the method that renders a scene: resolves `automatic` to rays, focused_dots or formula.
RenderMethod method_of(Scene const& scene);

/// Returns the name of the method in files: "focused_dots", "formula" or "rays" (also for `automatic`).
char const* to_string(RenderMethod method);

/// Renders every scene by its method, on one device. Dots that the fast renderer rejects, at a side face of the medium
/// or with lost rays, are rendered by individual rays, with a separate number of rays.
class SceneRenderer : public Renderer {
 public:
  /// @param focused_dots  fast renderer of that device
  /// @param rays          general renderer of that device
  SceneRenderer(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays);

  std::string device() const override { return rays_->device(); }
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;
  Rendering render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                             RenderImages images) override;

 private:
  /// Renders the particles whose light can reach the sensor; the others have no truth and zero planned rays.
  Rendering render_near_view(Scene& scene, Particles const& particles, RenderImages images);
  Rendering render_focused(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory);

  std::unique_ptr<Renderer> focused_dots_, rays_;
};

/// Determines the integration step of a scene. With two media, the shorter of both steps.
StepPlan plan_step_of(Scene& scene);
/// Determines the ray budget, and for "auto" the method, which it stores in scene.setup.render.method. It selects the
/// fast renderer if the interpolation error of its deflection table is within the accuracy goals of "auto", or smaller
/// than the scatter of the general renderer's rays; but the general renderer if the table takes more than 5 s and 60
/// times the processor time of the rays, and their number is given or sufficient.
RaysPlan plan_rays_of(Scene& scene);
/// Estimates the processor time for rendering a prepared scene: rays, deflection table and small-angle theory [s].
double render_seconds(Scene const& scene, RaysPlan const& plan, RenderTheory theory);
/// Maps density, gradient and small-angle theory (Eq. 9) of the scene's field over the view.
FieldMap field_of(Scene const& scene, int spacing_px);
/// Maps the strain of the displacement field over the view.
StrainMap strain_of(Scene const& scene);

}  // namespace gladstone
