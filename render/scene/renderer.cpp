#include "render/scene/renderer.h"

#include "render/base/error.h"
#include "render/scene/ray_hit.h"

namespace gladstone::inline scene {

char const* to_string(TableState state) {
  switch (state) {
    case TableState::made:
      break;
    case TableState::no_medium:
      return "no medium deflects rays";
    case TableState::no_sources:
      return "there are no dots";
    case TableState::by_rays:
      return "dots are rendered ray by ray (method = \"rays\")";
    case TableState::by_formula:
      return "images and truth are given by a formula, without rays (method = \"formula\")";
    case TableState::field_too_small:
      return "the field does not extend beyond the light cones of the dots";
    case TableState::field_too_fine:
      return "the field is so fine compared with the view that a table would need too many rays";
    case TableState::dots_too_wide:
      return "the dots are wide compared with the length scale of the field";
  }
  return "";
}

Rendering Renderer::render_particles(Scene const&, RenderPlan const&, Particles const&, ParticleLight, RenderImages) {
  throw DeviceError("this renderer supports dots only; particles need the general renderer");
}

TracingPass::TracingPass(Scene const& scene, RenderPlan const& plan, DotPattern const& sources) {
  std::size_t const count = sources.centre.size();
  rendering.rays = 2 * static_cast<std::int64_t>(count * plan.rays);
  rendering.truth.resize(count);
  rendering.truth.rays_planned.assign(count, static_cast<std::int64_t>(plan.rays));
  left_.resize(count);
  for (std::size_t dot = 0; dot < count; ++dot) {
    rendering.truth.position_m[dot] = {sources.centre[dot].x, sources.centre[dot].y, -scene.setup.z_d};
  }
}

void TracingPass::enter(std::size_t dot, DotTruth const& truth, std::int64_t rays, bool left) {
  rendering.truth.set_hits(dot, left ? DotTruth{} : truth, 1);
  rendering.truth.rays_planned[dot] = rays;
  left_[dot] = left;
}

Rendering TracingPass::finish() {
  rendering.rays = 0;
  for (std::size_t dot = 0; dot < left_.size(); ++dot) {
    rendering.rays += frame_count * rendering.truth.rays_planned[dot];
    if (left_[dot]) rendering.left.push_back(dot);
  }
  return std::move(rendering);
}

}  // namespace gladstone::inline scene
