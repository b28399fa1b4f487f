#pragma once

#include <functional>
#include <optional>

#include "render/focused_dots/deflection_map.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// The fast renderer on the CPU's cores.
class FocusedDotsRenderer : public Renderer {
 public:
  using Door = std::optional<FocusedDots> (*)(Scene const&);
  /// @param door by which scenes enter; with bench_rays it does what the GPU does with scenes that have no tables
  explicit FocusedDotsRenderer(Door door = focused_dots) : door_(door) {}

  std::string device() const override { return "cpu"; }
  /// @pre the door is open to the scene
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;

 private:
  Door door_;
  KeptDeflections<DeflectionMap> deflections_;
};

/// Traces a scene as often as it takes for the pupil to be wide enough for what the medium bends: what render() is on
/// every device.
Rendering render_with_margin(Scene& scene, std::function<TracingPass()> const& trace);

/// A white target seen by the camera: light per pixel, cos^4 of the angle to the axis. What dark dots are taken from;
/// the flow does not change it, since radiance is conserved along rays.
Image<double> white_light(Scene const& scene);

}  // namespace gladstone
