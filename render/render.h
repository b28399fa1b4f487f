#pragma once

#include <memory>
#include <string>

#include "render/ideal_images/ideal_images.h"
#include "render/scene/renderer.h"

/// Rendering of a scene: light on the sensor and true displacements.
namespace gladstone {

/// Device that renders each scene by the method of its setup. Two kinds of dots are rendered by individual rays in
/// place of the fast renderer: dots at side faces of the medium, which it does not support, and dots that it rejects
/// because their rays are lost. If the setup gives no number of rays, the number for these dots is adaptive.
class Device : public Renderer {
 public:
  /// @param focused_dots  fast renderer of this device
  /// @param rays          general renderer of this device
  /// @param drawer        drawer of ideal particle images; null: the CPU
  Device(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays,
         std::unique_ptr<ImageDrawer> drawer = nullptr);

  std::string device() const override { return rays_->device(); }
  Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                   RenderTheory theory) override;
  Rendering render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                             ParticleLight light, RenderImages images) override;

 private:
  /// Renders the particles whose light can reach the sensor; the others have no truth and zero planned rays.
  Rendering render_near_view(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                             RenderImages images);
  Rendering render_focused(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                           RenderTheory theory);
  /// Renders dots that the fast renderer does not support, as bright dots.
  Rendering render_others(Scene const& scene, RenderPlan plan, DotPattern const& dots, RenderImages images,
                          RenderTheory theory);

  std::unique_ptr<Renderer> focused_dots_, rays_;
  std::unique_ptr<ImageDrawer> drawer_;
};

/// Returns a device that renders on all cores of the CPU.
Device cpu();

/// Renders both frames of a scene (build_scene()): its dots, or the particles of a PIV scene.
/// The integration step, the number of rays and the method are chosen first (planning.h) if the setup does not give
/// them.
/// @param images  `no`: only displacements are computed
/// @param theory  whether small-angle theory (Eq. 9) is computed at every dot
/// @throws DataError if the scene does not meet the conditions of its method, Interrupted
Rendering render(Scene const& scene, Renderer& device, RenderImages images = RenderImages::yes,
                 RenderTheory theory = RenderTheory::yes);

/// Like render(), by a plan that is already known, without measuring the accuracy.
Rendering render(Scene const& scene, RenderPlan const& plan, Renderer& device, RenderImages images = RenderImages::yes,
                 RenderTheory theory = RenderTheory::yes);

}  // namespace gladstone
