#include "render/focused_dots/focused_dots_renderer.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/focused_dots/dot_integrator.h"
#include "render/focused_dots/owned_dot_model.h"
#include "render/scene/scene.h"

namespace gladstone::inline focused_dots {
namespace {

template <class Medium>
TracingPass trace_all(FocusedDots const& dots, DotPattern const& sources, Medium const& medium,
                      DeflectionTable const& table, RenderImages images, RenderTheory theory) {
  Scene const& scene = dots.scene();
  bool const lit = images != RenderImages::no;
  std::size_t const count = sources.centre.size();
  TracingPass pass(scene, dots.plan(), sources);
  std::optional<LightImage> frames[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; lit && frame < frame_count; ++frame) {
    targets[frame] = &frames[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  OwnedDotModel const owned(dots, sources, table, lit);
  TheoryModel const theory_model = dots.theory_model();
  std::mutex merge;
  Progress progress(lit ? "tracing rays" : "tracing truth", count);
  parallel_chunks(count, 16, [&](std::size_t begin, std::size_t end) {
    DotIntegrator integrator(owned.model);
    double largest_aim_distance = 0;
    for (std::size_t dot = begin; dot < end; ++dot) {
      RenderedDot const& seen = integrator.see(medium, sources.centre[dot], sources.radiance_of(dot));
      largest_aim_distance = std::max(largest_aim_distance, seen.largest_aim_distance);
      pass.enter(dot, seen.truth, seen.rays, seen.kind == DotKind::left);
      if (lit && seen.kind != DotKind::left) integrator.accumulate_light(targets);
      if (theory == RenderTheory::yes) {
        set_theory(pass.rendering.truth, dot, theory_model,
                   integrate_theory(OneLane{}, owned.model, theory_model, medium, sources.centre[dot]));
      }
    }
    progress.advance(end - begin);
    std::lock_guard const lock(merge);
    pass.largest_aim_distance = std::max(pass.largest_aim_distance, largest_aim_distance);
    add_counts(pass.rendering.statuses, integrator.statuses());
  });
  if (lit) pass.rendering.light = {frames[0]->to_light(), frames[1]->to_light()};
  return pass;
}

/// Subtracts the light of the dots from that of a white target if the dots are dark.
void apply_polarity(Scene const& scene, Polarity polarity, FramePair<double>& light) {
  if (polarity != Polarity::dark) return;
  Image<double> const white = render_white_light(scene);
  for (Image<double>* frame : {&light.reference, &light.flow}) {
    std::transform(white.begin(), white.end(), frame->begin(), frame->begin(),
                   [](double paper, double dots) { return paper - dots; });
  }
}

}  // namespace

Rendering FocusedDotsRenderer::render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources,
                                      RenderImages images, RenderTheory theory) {
  std::optional<FocusedDots> const dots = build_focused_dots(scene, plan);
  GLADSTONE_EXPECTS(dots);
  Rendering rendering = render_within_table(scene, plan, [&](double largest_aim_distance) {
    DeflectionTable const table = deflections_.table(*dots, sources, largest_aim_distance);
    return std::visit([&](auto const& medium) { return trace_all(*dots, sources, medium, table, images, theory); },
                      scene.medium.view);
  });
  rendering.table = deflections_.state();
  rendering.pupil_margin = plan.pupil_margin;
  if (images != RenderImages::no) apply_polarity(scene, plan.polarity, rendering.light);
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  return rendering;
}

Rendering render_within_table(Scene const& scene, RenderPlan const& plan,
                              std::function<TracingPass(double largest_aim_distance)> const& trace) {
  double room = std::max(DeflectionTableLayout::default_aim_distance(scene.imaging), plan.pupil_margin);
  while (true) {
    TracingPass pass = trace(room);
    if (pass.largest_aim_distance <= room) return pass.finish();
    check_deflection_limit(pass.largest_aim_distance, scene.setup.z_b());
    room = 1.5 * pass.largest_aim_distance;
  }
}

Image<double> render_white_light(Scene const& scene) {
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

}  // namespace gladstone::inline focused_dots
