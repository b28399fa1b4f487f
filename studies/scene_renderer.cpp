#include "studies/scene_renderer.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>

#include "render/base/contracts.h"
#include "render/focused_dots/dot_planning.h"
#include "render/focused_dots/focused_dots_renderer.h"
#include "render/ideal_images/ideal_images.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/scene/side_faces.h"
#include "render/scene/two_media.h"

namespace gladstone {
namespace {

FocusedDots enter(Scene const& scene) {
  std::optional<FocusedDots> const dots = focused_dots(scene);
  GLADSTONE_EXPECTS(dots);
  return *dots;
}

/// Some sources of a pattern.
DotPattern some_of(DotPattern const& all, std::vector<std::size_t> const& numbers) {
  DotPattern some;
  some.half_size = all.half_size;
  some.shape = all.shape;
  for (std::size_t const i : numbers) {
    some.centre.push_back(all.centre[i]);
    if (!all.radiance.empty()) some.radiance.push_back(all.radiance[i]);
  }
  return some;
}

/// The numbers below `count` that a rising list leaves out.
std::vector<std::size_t> others(std::vector<std::size_t> const& listed, std::size_t count) {
  std::vector<std::size_t> all(count), rest;
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::set_difference(all.begin(), all.end(), listed.begin(), listed.end(), std::back_inserter(rest));
  return rest;
}

/// A copy of a scene with other dots, so many rays each, bright.
Scene with_dots(Scene const& scene, DotPattern dots, std::uint64_t rays) {
  Scene copy = scene;
  copy.dots = std::move(dots);
  copy.rays_per_dot = rays;
  copy.setup.target.polarity = Polarity::bright;
  return copy;
}

/// Enters what was found of some sources among all.
void merge(Rendering& all, Rendering const& some, std::vector<std::size_t> const& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    all.truth.copy(some.truth, i, numbers[i]);
  }
  all.rays += some.rays;
  for (std::size_t frame = 0; frame < all.statuses.size(); ++frame) {
    for (std::size_t status = 0; status < ray_status_count; ++status) {
      all.statuses[frame][status] += some.statuses[frame][status];
    }
  }
  auto const add = [](Image<double>& to, Image<double> const& from) {
    if (to.empty()) {
      to = from;
    } else {
      std::transform(to.begin(), to.end(), from.begin(), to.begin(), std::plus<>());
    }
  };
  if (some.light.reference.empty()) return;
  add(all.light.reference, some.light.reference);
  add(all.light.flow, some.light.flow);
}

}  // namespace

RenderMethod method_of(Scene const& scene) {
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

SceneRenderer::SceneRenderer(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays)
    : focused_dots_(std::move(focused_dots)), rays_(std::move(rays)) {}

Rendering SceneRenderer::render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                                          RenderImages images) {
  if (scene.second_medium) return render_in_two_media(*this, scene, particles, light, images);
  if (method_of(scene) == RenderMethod::formula) {
    auto const ideal = ideal_images(scene);
    GLADSTONE_EXPECTS(ideal);
    Rendering rendering = render_ideal_images(*ideal, particles, light, images);
    rendering.device = "cpu";
    return rendering;
  }
  Rendering rendering = rays_->render_particles(scene, particles, light, images);
  rendering.device = device();
  return rendering;
}

Rendering SceneRenderer::render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) {
  RenderMethod const method = method_of(scene);
  Rendering rendering = method == RenderMethod::focused_dots ? render_focused(scene, sources, images, theory)
                                                             : rays_->render(scene, sources, images, theory);
  rendering.method = method;
  rendering.device = device();
  return rendering;
}

Rendering SceneRenderer::render_focused(Scene& scene, DotPattern const& sources, RenderImages images,
                                        RenderTheory theory) {
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, sources);
  if (at_faces.empty()) return focused_dots_->render(scene, sources, images, theory);
  std::vector<std::size_t> const clear = others(at_faces, sources.centre.size());
  RenderImages const lit = images == RenderImages::no ? RenderImages::no : RenderImages::yes;
  Rendering all;
  all.truth.resize(sources.centre.size());
  std::uint64_t const rays = std::max(scene.rays_per_dot, scene.rays_at_side_faces);
  Scene by_rays = with_dots(scene, some_of(sources, at_faces), rays);
  merge(all, rays_->render(by_rays, by_rays.dots, lit, theory), at_faces);
  Scene fast = with_dots(scene, some_of(sources, clear), scene.rays_per_dot);
  Rendering const of_clear = focused_dots_->render(fast, fast.dots, lit, theory);
  merge(all, of_clear, clear);
  all.table = clear.empty() ? TableState::by_rays : of_clear.table;
  scene.pupil_margin = std::max(fast.pupil_margin, by_rays.pupil_margin);
  if (lit == RenderImages::yes && scene.setup.target.polarity == Polarity::dark) {
    Image<double> const white = white_light(scene);
    for (Image<double>* frame : {&all.light.reference, &all.light.flow}) {
      std::transform(white.begin(), white.end(), frame->begin(), frame->begin(), std::minus<>());
    }
  }
  if (images == RenderImages::kept) {
    all.kept = std::make_shared<HostLight const>(std::move(all.light));
    all.light = {};
  }
  return all;
}

StepPlan plan_step_of(Scene& scene) {
  if (scene.second_medium) {  // the shorter step of both
    Scene first = scene, second = at_second_pulse(scene);
    first.second_medium.reset();
    StepPlan const a = plan_step_of(first), b = plan_step_of(second);
    StepPlan plan = b.step_mm < a.step_mm ? b : a;
    plan.largest_bend = std::max(a.largest_bend, b.largest_bend);
    use_step(scene, plan);
    return plan;
  }
  if (method_of(scene) != RenderMethod::focused_dots) return plan_step_by_rays(scene);
  StepPlan const plan = plan_step(enter(scene));
  use_step(scene, plan);
  return plan;
}

RaysPlan plan_rays_of(Scene& scene) {
  if (scene.second_medium) {  // the more rays of both
    Scene first = scene, second = at_second_pulse(scene);
    first.second_medium.reset();
    RaysPlan const a = plan_rays_of(first), b = plan_rays_of(second), plan = b.rays > a.rays ? b : a;
    scene.rays_per_dot = plan.rays;
    return plan;
  }
  if (method_of(scene) == RenderMethod::formula) {  // has none; what is written down is one
    RaysPlan plan;
    plan.rays = scene.rays_per_dot = 1;
    plan.bits = scene.setup.camera.bit_depth;
    return plan;
  }
  if (method_of(scene) == RenderMethod::rays) return plan_rays_by_rays(scene);
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, scene.dots);
  if (at_faces.empty() || scene.setup.render.rays_per_dot) {
    RaysPlan const plan = plan_rays(enter(scene));
    scene.rays_per_dot = plan.rays;
    return plan;
  }
  Scene const fast = with_dots(scene, some_of(scene.dots, others(at_faces, scene.dots.centre.size())), 1);
  RaysPlan plan = plan_rays(enter(fast));
  Scene by_rays = with_dots(scene, some_of(scene.dots, at_faces), 1);
  RaysPlan const at_side_faces = plan_rays_by_rays(by_rays);
  plan.rays_at_side_faces = std::max(plan.rays, at_side_faces.rays);
  plan.truth_error_px = std::max(plan.truth_error_px, at_side_faces.truth_error_px);
  plan.image_error_levels = std::max(plan.image_error_levels, at_side_faces.image_error_levels);
  plan.extrapolated = plan.extrapolated || at_side_faces.extrapolated;
  plan.converged = plan.converged && at_side_faces.converged;
  plan.rays_wanted = std::max(plan.rays_wanted, at_side_faces.rays_wanted);
  plan.seconds += at_side_faces.seconds;
  scene.rays_per_dot = plan.rays;
  scene.rays_at_side_faces = plan.rays_at_side_faces;
  return plan;
}

FieldMap field_of(Scene const& scene, int spacing_px) {
  return scene.setup.on_bench() ? map_field(scene, spacing_px) : map_field_by_rays(scene, spacing_px);
}

StrainMap strain_of(Scene const& scene) {
  return scene.setup.on_bench() ? map_strain(scene) : map_strain_by_rays(scene);
}

}  // namespace gladstone
