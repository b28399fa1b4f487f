#include "render/method.h"

#include <optional>
#include <string>

#include "render/base/error.h"
#include "render/focused_dots/deflection_map.h"

namespace gladstone {

RenderMethod resolve_render_method(Scene const& scene, RenderPlan const& plan) {
  bool const planned = plan.method != RenderMethod::automatic;
  RenderMethod const wanted = planned ? plan.method : scene.setup.render.method;
  if (wanted != RenderMethod::automatic) return wanted;
  if (scene.setup.has_ideal_particles()) return RenderMethod::formula;
  return build_focused_dots(scene) ? RenderMethod::focused_dots : RenderMethod::rays;
}

char const* to_string(RenderMethod method) {
  switch (method) {
    case RenderMethod::focused_dots:
      return "focused_dots";
    case RenderMethod::formula:
      return "formula";
    case RenderMethod::automatic:
    case RenderMethod::rays:
      break;
  }
  return "rays";
}

FocusedDots require_focused_dots(Scene const& scene, RenderPlan const& plan) {
  std::optional<FocusedDots> const dots = build_focused_dots(scene, plan);
  if (dots) return *dots;
  throw DataError(ErrorCode::invalid_value, KeyPath{"render.method"},
                  "\"focused_dots\" is not valid here, since " + std::string(to_string(table_state(scene))) +
                      "; use \"auto\" or \"rays\"");
}

}  // namespace gladstone
