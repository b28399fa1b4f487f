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

/// Renders every scene by its method: dots in focus on the device, whatever else on the CPU, ray by ray. (A device
/// takes bench scenes out of focus too, which it traces ray by ray itself.)
class SceneRenderer : public Renderer {
 public:
  /// @param only whether nothing but this device was asked for
  SceneRenderer(std::unique_ptr<Renderer> device, bool only);

  std::string device() const override { return device_->device(); }
  /// @throws DeviceError where only a device was asked for that cannot render the scene
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;

 private:
  std::unique_ptr<Renderer> device_, rays_;
  bool only_;
  bool told_ = false;
};

/// What plans a scene and maps its field, by its method.
StepPlan plan_step_of(Scene& scene);
RaysPlan plan_rays_of(Scene& scene);
FieldMap field_of(Scene const& scene, int spacing_px);
StrainMap strain_of(Scene const& scene);

}  // namespace gladstone
