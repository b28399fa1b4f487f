#include "render/method.h"

#include <optional>
#include <string>
#include <utility>

#include "render/base/error.h"
#include "render/focused_dots/deflection_map.h"

namespace gladstone {

RenderMethod resolve_render_method(Scene const& scene) {
  RenderMethod const wanted = scene.setup.render.method;
  if (wanted != RenderMethod::automatic) return wanted;
  if (scene.setup.piv && scene.setup.piv->particles.scattering == ParticleScattering::gaussian) {
    return RenderMethod::formula;
  }
  return focused_dots(scene) ? RenderMethod::focused_dots : RenderMethod::rays;
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

FocusedDots require_focused_dots(Scene const& scene) {
  std::optional<FocusedDots> const dots = focused_dots(scene);
  if (dots) return *dots;
  throw DataError("render.method", "\"focused_dots\" is not valid here, since " +
                                       std::string(to_string(table_state(scene))) + "; use \"auto\" or \"rays\"");
}

DotPattern select_dots(DotPattern const& all, std::vector<std::size_t> const& indices) {
  DotPattern some;
  some.half_size = all.half_size;
  some.shape = all.shape;
  for (std::size_t const i : indices) {
    some.centre.push_back(all.centre[i]);
    if (!all.radiance.empty()) some.radiance.push_back(all.radiance[i]);
  }
  return some;
}

Scene with_bright_dots(Scene const& scene, DotPattern dots, std::uint64_t rays) {
  Scene copy = scene;
  copy.dots = std::move(dots);
  copy.rays_per_dot = rays;
  copy.setup.target.polarity = Polarity::bright;
  return copy;
}

}  // namespace gladstone
