#pragma once

#include <functional>

#include "render/focused_dots/deflection_map.h"
#include "render/scene/renderer.h"

namespace gladstone::inline focused_dots {

/// Fast renderer on the CPU. Dots whose light cone is not covered by the table, is folded, or loses rays in the medium
/// are fallback dots (Rendering::left), without truth or light.
class FocusedDotsRenderer : public Renderer {
 public:
  std::string device() const override { return "cpu"; }
  /// @pre build_focused_dots(scene)
  Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                   RenderTheory theory) override;

 private:
  DeflectionTableCache<DeflectionMap> deflections_;
};

/// Renders with a deflection table of default size, or of the size that the deflections found when the step was chosen
/// require if that is larger, and again with a larger table if a dot's aim point is outside it. Implements render() on
/// every device. The size of a table does not change the results of dots that it covers.
/// @param trace  renders once with a table that covers aim points up to a given distance from the axis [m]
Rendering render_within_table(Scene const& scene, RenderPlan const& plan,
                              std::function<TracingPass(double largest_aim_distance)> const& trace);

/// Renders a white target: light per pixel, cos^4 of the angle to the axis. Dark dots are subtracted from it. It is the
/// same in both images, since radiance is conserved along rays.
Image<double> render_white_light(Scene const& scene);

}  // namespace gladstone::inline focused_dots
