#include "studies/case/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>

#include "render/base/error.h"
#include "render/focused_dots/focused_dots_renderer.h"
#include "render/focused_dots/table_error.h"
#include "render/ideal_images/ideal_images.h"
#include "render/rays/particles_in_view.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/scene/side_faces.h"
#include "render/scene/two_media.h"

namespace gladstone {
namespace {

/// @throws DataError if the scene does not meet the conditions of "focused_dots"
FocusedDots enter(Scene const& scene) {
  std::optional<FocusedDots> const dots = focused_dots(scene);
  if (dots) return *dots;
  throw DataError("render.method", "\"focused_dots\" is not valid here, since " +
                                       std::string(to_string(table_state(scene))) + "; use \"auto\" or \"rays\"");
}

/// Selects some sources of a pattern.
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

/// Copies a scene with other, bright dots and the given number of rays per dot (maximum if chosen per dot).
Scene with_dots(Scene const& scene, DotPattern dots, std::uint64_t rays) {
  Scene copy = scene;
  copy.dots = std::move(dots);
  copy.rays_per_dot = rays;
  copy.setup.target.polarity = Polarity::bright;
  return copy;
}

/// Merges the rendering of some sources, rendered as bright dots, into that of all.
void merge(Rendering& all, Rendering const& some, std::vector<std::size_t> const& numbers, Polarity polarity) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    all.truth.copy(some.truth, i, numbers[i]);
  }
  all.rays += some.rays;
  for (std::size_t frame = 0; frame < all.statuses.size(); ++frame) {
    for (std::size_t status = 0; status < ray_status_count; ++status) {
      all.statuses[frame][status] += some.statuses[frame][status];
    }
  }
  // the light of dark dots is subtracted from the light of white paper
  double const sign = polarity == Polarity::dark ? -1 : 1;
  auto const add = [sign](Image<double>& to, Image<double> const& from) {
    std::transform(to.begin(), to.end(), from.begin(), to.begin(),
                   [sign](double there, double light) { return there + sign * light; });
  };
  if (some.light.reference.empty()) return;
  add(all.light.reference, some.light.reference);
  add(all.light.flow, some.light.flow);
}

/// Subtracts the ray counts of a rendering from those of another.
void take_back(Rendering& all, Rendering const& some) {
  all.rays -= some.rays;
  for (std::size_t frame = 0; frame < all.statuses.size(); ++frame) {
    for (std::size_t status = 0; status < ray_status_count; ++status) {
      all.statuses[frame][status] -= some.statuses[frame][status];
    }
  }
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
  bool const as_lit = light == ParticleLight::scattered && images != RenderImages::no;
  Rendering rendering =
      as_lit ? render_near_view(scene, particles, images) : rays_->render_particles(scene, particles, light, images);
  rendering.device = device();
  return rendering;
}

Rendering SceneRenderer::render_near_view(Scene& scene, Particles const& particles, RenderImages images) {
  std::vector<char> const near = particles_near_view(scene, particles);
  if (std::find(near.begin(), near.end(), 0) == near.end()) {
    return rays_->render_particles(scene, particles, ParticleLight::scattered, images);
  }
  Particles lit = particles;  // particles without light are not traced
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] == 0) lit.photons[0][i] = lit.photons[1][i] = 0;
  }
  Rendering rendering = rays_->render_particles(scene, lit, ParticleLight::scattered, images);
  std::vector<std::int64_t>& planned = rendering.truth.rays_planned;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] == 0) planned[i] = 0;
  }
  rendering.rays = frame_count * std::accumulate(planned.begin(), planned.end(), std::int64_t{0});
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
  enter(scene);
  Rendering all = focused_dots_->render(scene, sources, images, theory);
  if (all.left.empty()) return all;
  std::vector<std::size_t> const left = all.left;
  RenderImages const lit = images == RenderImages::no ? RenderImages::no : RenderImages::yes;
  if (auto const light = std::exchange(all.in_place, nullptr)) all.light = light->to_host();
  Scene by_rays = with_dots(scene, some_of(sources, left), std::max(scene.rays_per_dot, scene.rays_at_side_faces));
  if (!scene.by_need && !scene.setup.render.rays_per_dot) {  // the ray budget did not include these dots
    by_rays.by_need = need_of(scene);
    by_rays.rays_per_dot = most_rays_of_source(by_rays);
  }
  merge(all, rays_->render(by_rays, by_rays.dots, lit, theory), left, scene.setup.target.polarity);
  scene.pupil_margin = std::max(scene.pupil_margin, by_rays.pupil_margin);
  // Subtract the rays that the fast renderer traced for these dots before rejecting them; otherwise they count twice.
  Scene given_up = scene;
  take_back(all, focused_dots_->render(given_up, by_rays.dots, RenderImages::no, RenderTheory::no));
  if (images == RenderImages::in_place) {
    all.in_place = std::make_shared<HostLight const>(std::move(all.light));
    all.light = {};
  }
  return all;
}

StepPlan plan_step_of(Scene& scene) {
  if (scene.second_medium) {  // use the shorter step of both media
    Scene first = scene, second = at_second_pulse(scene);
    first.second_medium.reset();
    StepPlan const a = plan_step_of(first), b = plan_step_of(second);
    StepPlan plan = b.step_mm < a.step_mm ? b : a;
    plan.largest_shift = std::max(a.largest_shift, b.largest_shift);
    use_step(scene, plan);
    return plan;
  }
  return plan_step_by_rays(scene);
}

namespace {

/// Determines the rays of dots rejected by the fast renderer because of the field's side faces. If their number is
/// given, measures the resulting errors of truth and images.
void plan_rays_at_side_faces(Scene& scene, RaysPlan& plan) {
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, scene.dots);
  if (at_faces.empty()) return;
  auto const given = scene.setup.render.rays_per_dot;
  Scene by_rays = with_dots(scene, some_of(scene.dots, at_faces), given.value_or(1));
  bool const seen = std::any_of(by_rays.dots.centre.begin(), by_rays.dots.centre.end(),
                                [&scene](Vec2d centre) { return scene.in_view(centre); });
  if (given && !seen) return;
  // upper limit of the rays per dot, so that measuring costs no more than rendering
  constexpr std::uint64_t cheap_rays = 256;
  RaysPlan const at_side_faces =
      given ? measure_rays_by_rays(by_rays, cheap_rays) : plan_rays_by_rays(by_rays, need_of(scene));
  if (seen) {
    plan.side_faces = {at_faces.size(), at_side_faces.rays, at_side_faces.truth_error_px,
                       at_side_faces.image_error_levels, at_side_faces.rays_wanted};
  }
  if (given) return;
  plan.by_need = at_side_faces.by_need;
  plan.rays_at_side_faces = at_side_faces.most;
  plan.truth_error_px = std::fmax(plan.truth_error_px, at_side_faces.truth_error_px);
  plan.image_error_levels = std::fmax(plan.image_error_levels, at_side_faces.image_error_levels);
  plan.extrapolated = at_side_faces.extrapolated;
  plan.converged = plan.converged && at_side_faces.converged;
  plan.rays_wanted = std::max(plan.rays_wanted, at_side_faces.rays_wanted);  // NaN persists
  plan.seconds += at_side_faces.seconds;
}

/// Returns a ray budget if tracing a few dots is much cheaper than the deflection table, whose cost is independent of
/// their number. Returns nullopt otherwise, or if the rays allowed by "auto" do not reach the accuracy goals.
std::optional<RaysPlan> plan_cheaper_rays(Scene const& scene) {
  constexpr double long_s = 5, much_cheaper = 60;
  if (scene.setup.render.method != RenderMethod::automatic) return std::nullopt;
  double const by_table = table_seconds(enter(scene));
  auto const given = given_rays(scene.setup);
  double const rays = static_cast<double>(given ? given->rays : most_rays_of_source(scene));
  if (by_table < long_s || much_cheaper * rays * rays_seconds(scene) > by_table) return std::nullopt;
  Scene searched = scene;
  RaysPlan plan = plan_rays_by_rays(searched);
  if (!given && plan.excess() > 1) return std::nullopt;
  plan.method = RenderMethod::rays;
  return plan;
}

}  // namespace

RaysPlan plan_rays_of(Scene& scene) {
  if (scene.second_medium) {  // use the larger number of rays of both media
    Scene first = scene, second = at_second_pulse(scene);
    first.second_medium.reset();
    RaysPlan const a = plan_rays_of(first), b = plan_rays_of(second), plan = b.rays > a.rays ? b : a;
    use_rays(scene, plan);
    return plan;
  }
  if (method_of(scene) == RenderMethod::formula) {  // no rays are traced; the recorded number is one
    RaysPlan plan;
    plan.rays = scene.rays_per_dot = 1;
    plan.bits = scene.setup.camera.bit_depth;
    return plan;
  }
  if (method_of(scene) == RenderMethod::rays) return plan_rays_by_rays(scene);
  if (auto const cheaper = plan_cheaper_rays(scene)) {
    scene.setup.render.method = RenderMethod::rays;
    use_rays(scene, *cheaper);
    return *cheaper;
  }
  constexpr std::uint64_t rivals = 4096;  // rays per dot; fewer scatter by more than the table's error
  RaysPlan plan = plan_rays(enter(scene));
  auto const given = given_rays(scene.setup);
  if (scene.setup.render.method == RenderMethod::automatic) {
    plan.method = RenderMethod::focused_dots;
    if (given && given->rays >= rivals) {
      scene.rays_per_dot = given->rays;
      plan = measure_table_error(enter(scene));
      plan.method = RenderMethod::focused_dots;
    }
    if (plan.excess() > 1) {  // Compare with the general renderer.
      auto const by_rays_of = [&](Scene other) {
        RaysPlan const by_rays = plan_rays_by_rays(other);
        return given ? measure_rays_by_rays(other) : by_rays;
      };
      // Use the same dots for both, so that the choice does not depend on the sample.
      if (by_rays_of(with_dots(scene, measured_places(scene), scene.rays_per_dot)).excess() < plan.excess()) {
        plan = by_rays_of(scene);
        plan.method = RenderMethod::rays;
      }
    }
    scene.setup.render.method = plan.method;
  }
  scene.rays_per_dot = plan.rays;
  if (plan.method != RenderMethod::rays) plan_rays_at_side_faces(scene, plan);
  use_rays(scene, plan);
  return plan;
}

double render_seconds(Scene const& scene, RaysPlan const& plan, RenderTheory theory) {
  RenderMethod const method = method_of(scene);
  if (method == RenderMethod::formula) return 0;
  if (method == RenderMethod::focused_dots) return dots_seconds(enter(scene), theory);
  double const media = scene.second_medium ? 2 : 1;
  double const rays = std::isfinite(plan.seconds) ? plan.seconds : static_cast<double>(plan.rays) * rays_seconds(scene);
  return media * rays + (theory == RenderTheory::yes && !scene.setup.piv ? theory_seconds(scene) : 0);
}

FieldMap field_of(Scene const& scene, int spacing_px) {
  return scene.setup.on_bench() ? map_field(scene, spacing_px) : map_field_by_rays(scene, spacing_px);
}

StrainMap strain_of(Scene const& scene) {
  return scene.setup.on_bench() ? map_strain(scene) : map_strain_by_rays(scene);
}

}  // namespace gladstone
