#pragma once

#include <functional>

#include "render/focused_dots/deflection_map.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// The fast renderer on the CPU's cores. Dots whose cones the table does not cover, or that get lost or fold in the
/// medium, are left (Rendering::left): without truth or light.
class FocusedDotsRenderer : public Renderer {
 public:
  std::string device() const override { return "cpu"; }
  /// @pre focused_dots(scene)
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;

 private:
  LastDeflections<DeflectionMap> deflections_;
};

/// Renders by a table with room for usual bends, and again by a larger one where a dot is aimed at beyond it: what
/// render() is on every device. A table's size changes nothing of the dots that it covers.
/// @param trace one try, with a table that has room for such aims [m]
Rendering render_within_table(Scene const& scene, std::function<TracingPass(double farthest_aim)> const& trace);

/// A white target seen by the camera: light per pixel, cos^4 of the angle to the axis. What dark dots are taken from;
/// the flow does not change it, since radiance is conserved along rays.
Image<double> white_light(Scene const& scene);

}  // namespace gladstone
