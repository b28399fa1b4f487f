#include "render/scene/renderer.h"

#include "render/base/error.h"

namespace gladstone {

char const* to_string(TableState state) {
  switch (state) {
    case TableState::made:
      break;
    case TableState::no_medium:
      return "nothing bends rays";
    case TableState::no_sources:
      return "there are no dots";
    case TableState::chief_rays:
      return "chief rays alone are traced (lens.f_number = inf)";
    case TableState::random_rays:
      return "render.sampling = \"random\" takes rays as they are";
    case TableState::out_of_focus:
      return "the lens is not focused on the target";
    case TableState::by_rays:
      return "dots are rendered ray by ray (method = \"rays\")";
    case TableState::field_too_small:
      return "the field does not reach beyond the dots' cones of rays";
    case TableState::field_too_fine:
      return "the field is so fine that a table for these few dots would take more rays than it saves";
    case TableState::dots_too_wide:
      return "the dots are wide beside what the field changes on";
  }
  return "";
}

Rendering Renderer::render_particles(Scene&, Particles const&, ParticleLight, RenderImages) {
  throw DeviceError("this renderer traces dots alone; particles are traced by the general one");
}

TracingPass::TracingPass(Scene const& scene, DotPattern const& sources) {
  std::size_t const count = sources.centre.size();
  rendering.rays = 2 * static_cast<std::int64_t>(count * scene.rays_per_dot);
  rendering.truth.resize(count);
  rendering.truth.rays_planned.assign(count, static_cast<std::int64_t>(scene.rays_per_dot));
  for (std::size_t dot = 0; dot < count; ++dot) {
    rendering.truth.position_m[dot] = {sources.centre[dot].x, sources.centre[dot].y, -scene.setup.z_d};
  }
}

}  // namespace gladstone
