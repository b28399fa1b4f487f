#include "render/render.h"

#include <algorithm>
#include <utility>

#include "render/accuracy.h"
#include "render/base/contracts.h"
#include "render/focused_dots/focused_dots_renderer.h"
#include "render/ideal_images/ideal_images.h"
#include "render/method.h"
#include "render/planning.h"
#include "render/rays/particles_in_view.h"
#include "render/rays/ray_planning.h"
#include "render/rays/rays_renderer.h"
#include "render/rays/trace_particles.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/side_faces.h"
#include "render/scene/source_sample.h"
#include "render/scene/two_media.h"

namespace gladstone {
namespace {

/// Returns the indices from 0 to count - 1 that are not in a sorted list.
std::vector<std::size_t> indices_without(std::size_t count, std::vector<std::size_t> const& some) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::binary_search(some.begin(), some.end(), i)) others.push_back(i);
  }
  return others;
}

/// Adds the rendering of the dots with the given indices to that of all dots.
/// @param sign  sign of the added light: -1 for dark dots, whose light is subtracted from white paper
void merge(Rendering& all, Rendering const& some, std::vector<std::size_t> const& indices, double sign) {
  for (std::size_t i = 0; i < indices.size(); ++i) all.truth.copy(some.truth, i, indices[i]);
  all.rays += some.rays;
  add_counts(all.statuses, some.statuses);
  all.pupil_margin = std::max(all.pupil_margin, some.pupil_margin);
  auto const add = [sign](Image<double>& to, Image<double> const& from) {
    std::transform(to.begin(), to.end(), from.begin(), to.begin(),
                   [sign](double there, double light) { return there + sign * light; });
  };
  if (some.light.reference.empty()) return;
  add(all.light.reference, some.light.reference);
  add(all.light.flow, some.light.flow);
}

/// Extends a rendering of the dots with the given indices to `count` dots. The others get no true displacement.
void widen(Rendering& rendering, std::vector<std::size_t> const& indices, std::size_t count) {
  GroundTruth all;
  all.resize(count);
  for (std::size_t i = 0; i < indices.size(); ++i) all.copy(rendering.truth, i, indices[i]);
  rendering.truth = std::move(all);
  for (std::size_t& dot : rendering.left) dot = indices[dot];
}

/// Returns a plan with the method by which it renders a scene.
RenderPlan with_method(Scene const& scene, RenderPlan plan) {
  plan.method = resolve_render_method(scene, plan);
  return plan;
}

}  // namespace

Device::Device(std::unique_ptr<Renderer> focused_dots, std::unique_ptr<Renderer> rays,
               std::unique_ptr<ImageDrawer> drawer)
    : focused_dots_(std::move(focused_dots)), rays_(std::move(rays)), drawer_(std::move(drawer)) {}

Rendering Device::render_particles(Scene const& scene, RenderPlan const& given, Particles const& particles,
                                   ParticleLight light, RenderImages images) {
  if (scene.second_medium) return render_in_two_media(*this, scene, given, particles, light, images);
  RenderPlan const plan = with_method(scene, given);
  if (plan.method == RenderMethod::formula) {
    auto const ideal = build_ideal_images(scene);
    GLADSTONE_EXPECTS(ideal);
    Rendering rendering = render_ideal_images(*ideal, particles, light, images, drawer_.get());
    rendering.device = drawer_ ? drawer_->device() : "cpu";
    rendering.plan = plan;
    return rendering;
  }
  bool const as_lit = light == ParticleLight::scattered && images != RenderImages::no;
  Rendering rendering = as_lit ? render_near_view(scene, plan, particles, images)
                               : rays_->render_particles(scene, plan, particles, light, images);
  rendering.plan = plan;
  rendering.device = device();
  return rendering;
}

Rendering Device::render_near_view(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                   RenderImages images) {
  std::vector<char> const near = particles_near_view(scene, plan, particles);
  if (std::find(near.begin(), near.end(), 0) == near.end()) {
    return rays_->render_particles(scene, plan, particles, ParticleLight::scattered, images);
  }
  Particles lit = particles;  // particles without light are not traced
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] == 0) lit.photons[0][i] = lit.photons[1][i] = 0;
  }
  Rendering rendering = rays_->render_particles(scene, plan, lit, ParticleLight::scattered, images);
  std::vector<std::int64_t>& planned = rendering.truth.rays_planned;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] == 0) planned[i] = 0;
  }
  count_rays(rendering);
  return rendering;
}

Rendering Device::render(Scene const& scene, RenderPlan const& given, DotPattern const& sources, RenderImages images,
                         RenderTheory theory) {
  RenderPlan const plan = with_method(scene, given);
  Rendering rendering = plan.method == RenderMethod::focused_dots ? render_focused(scene, plan, sources, images, theory)
                                                                  : rays_->render(scene, plan, sources, images, theory);
  rendering.plan = plan;
  rendering.device = device();
  return rendering;
}

Rendering Device::render_focused(Scene const& scene, RenderPlan const& plan, DotPattern const& sources,
                                 RenderImages images, RenderTheory theory) {
  require_focused_dots(scene);
  std::size_t const count = sources.centre.size();
  std::vector<std::size_t> const at_faces = sources_at_side_faces(scene, plan, sources);
  bool const some = !at_faces.empty() && at_faces.size() < count;
  Rendering all;
  if (some) {
    std::vector<std::size_t> const supported = indices_without(count, at_faces);
    all = focused_dots_->render(scene, plan, select_dots(sources, supported), images, theory);
    widen(all, supported, count);
    all.left.insert(all.left.end(), at_faces.begin(), at_faces.end());
    std::sort(all.left.begin(), all.left.end());
  } else {
    all = focused_dots_->render(scene, plan, sources, images, theory);
  }
  if (all.left.empty()) return all;
  if (auto const light = std::exchange(all.in_place, nullptr)) all.light = light->to_host();
  double const sign = plan.polarity == Polarity::dark ? -1 : 1;
  merge(all, render_others(scene, plan, select_dots(sources, all.left), images, theory), all.left, sign);
  if (images == RenderImages::in_place) all.store_light_in_place();
  return all;
}

Rendering Device::render_others(Scene const& scene, RenderPlan plan, DotPattern const& dots, RenderImages images,
                                RenderTheory theory) {
  if (!plan.given_rays) {
    if (images == RenderImages::no) {
      plan.adaptive_criteria = AdaptiveRayCriteria{};  // criteria for the truth alone, without images
    } else if (!plan.adaptive_criteria) {
      plan.adaptive_criteria = determine_adaptive_criteria(scene, plan);
    }
    plan.rays = max_rays_per_source(scene, plan);
  }
  plan.polarity = Polarity::bright;
  return rays_->render(scene, plan, dots, images == RenderImages::no ? images : RenderImages::yes, theory);
}

Device cpu() { return {std::make_unique<FocusedDotsRenderer>(), std::make_unique<RaysRenderer>()}; }

Rendering render(Scene const& scene, RenderPlan const& plan, Renderer& device, RenderImages images,
                 RenderTheory theory) {
  Rendering rendering = scene.setup.experiment().sources.on_target
                            ? device.render(scene, plan, scene.dots, images, theory)
                            : device.render_particles(scene, plan, scene.particles, ParticleLight::scattered, images);
  if (rendering.device.empty()) rendering.device = device.device();
  return rendering;
}

Rendering render(Scene const& scene, Renderer& device, RenderImages images, RenderTheory theory) {
  Rendering rendering = render(scene, plan_rendering(scene), device, images, theory);
  if (images == RenderImages::no) return rendering;
  double const exposure_e = rendering.in_place ? choose_exposure(scene, *rendering.in_place)
                                               : choose_exposure(scene, HostLight(rendering.light));
  rendering.accuracy = measure_accuracy(scene, rendering.plan, rendering.truth, exposure_e);
  return rendering;
}

}  // namespace gladstone
