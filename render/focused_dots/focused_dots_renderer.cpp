#include "render/focused_dots/focused_dots_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>

#include "render/base/contracts.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/focused_dots/dot_exposure.h"
#include "render/focused_dots/light_model.h"
#include "render/focused_dots/trace_pair.h"

namespace gladstone {
namespace {

/// Eq. 9, its own-lever form and its average over disc and pupil, for one dot.
template <class Medium>
void record_theory(LightModel const& light, TheoryModel const& model, SceneView<double> const& view,
                   Medium const& medium, std::size_t dot, std::uint64_t rays, GroundTruth& truth) {
  ConeSum cone;
  for (std::uint64_t ray = 0; ray < theory_rays(light, rays); ++ray) {
    throw_if_interrupted();
    add_straight_ray(light, model, view, medium, dot, ray, cone);
  }
  set_theory(truth, dot, model, integrate_chief(model, view, medium, dot), cone);
}

template <class Medium>
TracingPass trace_all(FocusedDots const& dots, DotPattern const& sources, Medium const& medium,
                      DeflectionTable const& deflections, SpotView const* spot, RenderTheory theory) {
  Scene const& scene = dots.scene();
  TracePair<double, Medium> const pair{dots.view(sources), medium};
  std::size_t const count = sources.centre.size();
  double const light_per_ray = dots.light_per_ray(sources);
  TracingPass pass(scene, sources);
  std::optional<LightImage> images[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; spot && frame < frame_count; ++frame) {
    targets[frame] = &images[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  OwnedLightModel const light(dots, sources, spot, deflections);
  TheoryModel const theory_model = dots.theory_model();
  std::mutex merge;
  Progress progress(spot ? "tracing rays" : "tracing truth", count);
  parallel_chunks(count, 16, [&](std::size_t begin, std::size_t end) {
    DotExposure exposure(light.model, spot != nullptr);
    GroundTruth& truth = pass.rendering.truth;
    for (std::size_t dot = begin; dot < end; ++dot) {
      Vec2d const centre = sources.centre[dot];
      exposure.begin(centre, sources.radiance_of(dot), targets, light_per_ray);
      trace_dot(pair, dot, scene.rays_per_dot, exposure);
      exposure.finish(truth, dot);
      if (theory == RenderTheory::yes) {
        record_theory(light.model, theory_model, pair.scene, medium, dot, scene.rays_per_dot, truth);
      }
    }
    progress.advance(end - begin);
    std::lock_guard const lock(merge);
    pass.largest_bend = std::max(pass.largest_bend, exposure.largest_bend());
    for (std::size_t frame = 0; frame < 2; ++frame) {
      for (std::size_t status = 0; status < ray_status_count; ++status) {
        pass.rendering.statuses[frame][status] += exposure.statuses()[frame][status];
      }
    }
  });
  if (spot) pass.rendering.light = {images[0]->to_light(), images[1]->to_light()};
  return pass;
}

/// Turns the light that bright dots send into what the target's polarity says: dark dots are taken from a white target.
void apply_polarity(Scene const& scene, LightPair& light) {
  if (scene.setup.target.polarity != Polarity::dark) return;
  Image<double> const white = white_light(scene);
  for (Image<double>* frame : {&light.reference, &light.flow}) {
    std::transform(white.begin(), white.end(), frame->begin(), frame->begin(),
                   [](double paper, double dots) { return paper - dots; });
  }
}

}  // namespace

Rendering FocusedDotsRenderer::render(Scene& scene, DotPattern const& sources, RenderImages images,
                                      RenderTheory theory) {
  std::optional<FocusedDots> const dots = door_(scene);
  GLADSTONE_EXPECTS(dots);
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  Rendering rendering = render_with_margin(scene, [&] {
    DeflectionTable const deflections = deflections_.table(*dots, sources);
    return std::visit(
        [&](auto const& medium) {
          return trace_all(*dots, sources, medium, deflections, images == RenderImages::no ? nullptr : &spot, theory);
        },
        scene.medium.view);
  });
  rendering.table = deflections_.state();
  if (images != RenderImages::no) apply_polarity(scene, rendering.light);
  if (images == RenderImages::kept) {
    rendering.kept = std::make_shared<HostLight const>(std::move(rendering.light));
    rendering.light = {};
  }
  return rendering;
}

Rendering render_with_margin(Scene& scene, std::function<TracingPass()> const& trace) {
  while (true) {
    TracingPass pass = trace();
    if (scene.chief_rays_only() || pass.largest_bend <= scene.pupil_margin) return std::move(pass.rendering);
    scene.widen_pupil(1.02 * pass.largest_bend);
  }
}

Image<double> white_light(Scene const& scene) {
  Image<double> light(scene.setup.camera.columns, scene.setup.camera.rows);
  for (int row = 0; row < light.rows(); ++row) {
    for (int column = 0; column < light.columns(); ++column) {
      double const x = (column - 0.5 * (light.columns() - 1)) * scene.setup.camera.pixel_pitch;
      double const y = (row - 0.5 * (light.rows() - 1)) * scene.setup.camera.pixel_pitch;
      double const z = scene.imaging.image_distance;
      double const cosine2 = z * z / (z * z + x * x + y * y);
      light(column, row) = cosine2 * cosine2;
    }
  }
  return light;
}

}  // namespace gladstone
