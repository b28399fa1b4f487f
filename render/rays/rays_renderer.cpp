#include "render/rays/rays_renderer.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/ray_theory.h"
#include "render/rays/source_tracer.h"
#include "render/rays/trace_particles.h"
#include "render/scene/spot.h"

namespace gladstone::inline rays {
namespace {

template <class Medium>
Rendering trace_all(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, Medium const& medium,
                    SpotView const* spot, RenderTheory theory) {
  RaysLaunch const launch(scene, plan, spot ? *spot : SpotView{});
  LambertSources<double> const lambert{sources.view(-scene.setup.z_d)};
  RaysLadder const ladder = RaysLadder::of_points(scene, plan, launch, spot ? RenderImages::yes : RenderImages::no);
  std::size_t const count = sources.centre.size();
  TracingPass pass(scene, plan, sources);
  std::optional<LightImage> images[frame_count];
  LightImage* targets[frame_count] = {};
  for (int frame = 0; spot && frame < frame_count; ++frame) {
    targets[frame] = &images[frame].emplace(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  RayTheory const model(scene, launch, sources.shape, sources.half_size > 0);
  bool const one_path = scene.chief_rays_only() && sources.half_size == 0;  // all rays of a source are identical
  double margin = 0;
  std::mutex merge;
  Progress progress(spot ? "tracing rays" : "tracing truth", count);
  parallel_chunks(count, 8, [&](std::size_t begin, std::size_t end) {
    SourceTracer tracer(ladder, launch.camera.view(), lambert, medium, spot != nullptr);
    GroundTruth& truth = pass.rendering.truth;
    for (std::size_t dot = begin; dot < end; ++dot) {
      DotTruth const found = tracer.trace(dot, targets);
      truth.set_hits(dot, found, tracer.launch().light_per_weight(lambert.area()));
      truth.rays_planned[dot] = static_cast<std::int64_t>(tracer.launch().rays);
      if (one_path) truth.displacement_error_px[dot] = {};
      if (theory == RenderTheory::yes) model.record(launch, lambert, medium, dot, truth);
    }
    progress.advance(end - begin);
    std::lock_guard const lock(merge);
    margin = std::max(margin, tracer.largest_margin());
    add_counts(pass.rendering.statuses, tracer.statuses());
  });
  if (spot) pass.rendering.light = {images[0]->to_light(), images[1]->to_light()};
  pass.rendering.pupil_margin = margin;
  return pass.finish();
}

/// Camera whose rays land where an ideal lens in its place would image their apparent point of origin.
struct IdealView : CameraView<double> {
  Camera const* camera;
  double plane_z;  ///< Z of the target [m]
  double seen_z;   ///< apparent Z of the target through the elements in front of the medium [m]
};

template <int N>
void finish_rays(IdealView const& view, Ray<double> (&ray)[N], RayAccount<double> (&account)[N], RayStatus (&status)[N],
                 RayHit<double> (&hit)[N]) {
  Ray<double> came[N];
  std::copy_n(ray, N, came);
  finish_rays(static_cast<CameraView<double> const&>(view), ray, account, status, hit);
  for (int i = 0; i < N; ++i) {
    if (hit[i].weight == 0) continue;
    double const way = (view.seen_z - came[i].position.z) / came[i].direction.z;
    Vec3d const apparent = came[i].position + way * came[i].direction;
    hit[i].pixel = view.camera->ideal_project({apparent.x, apparent.y, view.plane_z});
  }
}

/// Subtracts the light of bright dots from a white target.
void take_from_white(Scene const& scene, std::uint64_t seed, FramePair<double>& light) {
  Image<double> const white = render_white_target(scene, seed);
  for (Image<double>* frame : {&light.reference, &light.flow}) {
    std::transform(white.begin(), white.end(), frame->begin(), frame->begin(),
                   [](double paper, double dots) { return paper - dots; });
  }
}

}  // namespace

Rendering RaysRenderer::render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources,
                               RenderImages images, RenderTheory theory) {
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  Rendering rendering = std::visit(
      [&](auto const& medium) {
        return trace_all(scene, plan, sources, medium, images == RenderImages::no ? nullptr : &spot, theory);
      },
      scene.medium.view);
  rendering.table = TableState::by_rays;
  if (images != RenderImages::no && plan.polarity == Polarity::dark) {
    take_from_white(scene, plan.seed, rendering.light);
  }
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  return rendering;
}

Rendering RaysRenderer::render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                         ParticleLight light, RenderImages images) {
  return trace_particles(scene, plan, particles, light, images);
}

std::vector<Vec2d> ideal_displacements(Scene const& scene, RenderPlan const& plan, DotPattern const& sources) {
  RaysLaunch const launch(scene, plan, SpotView{});
  RaysLadder const ladder = RaysLadder::of_points(scene, plan, launch, RenderImages::no);
  LambertSources<double> const lambert{sources.view(-scene.setup.z_d)};
  IdealView const view{launch.camera.view(), &launch.camera, -scene.setup.z_d,
                       -scene.setup.z_d + scene.setup.element_shift(ElementSide::target)};
  std::vector<Vec2d> displacement(sources.centre.size(), Vec2d{not_a_number, not_a_number});
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(displacement.size(), 8, [&](std::size_t begin, std::size_t end) {
          SourceTracer tracer(ladder, view, lambert, medium, false);
          for (std::size_t dot = begin; dot < end; ++dot) {
            DotTruth const truth = tracer.trace(dot, {});
            displacement[dot] = truth.hits[1].mean() - truth.hits[0].mean();
          }
        });
      },
      scene.medium.view);
  return displacement;
}

Image<double> render_white_target(Scene const& scene, std::uint64_t seed) {
  constexpr int nodes = 17;
  RenderPlan plan;
  plan.rays = 4096;
  plan.seed = seed;
  RaysLaunch const launch(scene, plan, SpotView{});
  CameraView<double> const camera = launch.camera.view();
  Vec2d const centre{};
  LambertSources<double> const paper{{&centre, nullptr, 1, -scene.setup.z_d, 0, SourceShape::disc}};
  int const columns = scene.setup.camera.columns, rows = scene.setup.camera.rows;
  Image<double> lattice(nodes, nodes);
  parallel_for(static_cast<std::size_t>(nodes) * nodes, [&](std::size_t index) {
    int const column = static_cast<int>(index) % nodes, row = static_cast<int>(index) / nodes;
    Vec2d const pixel{(columns - 1.0) * column / (nodes - 1), (rows - 1.0) * row / (nodes - 1)};
    auto const seen = launch.camera.unproject(pixel, scene.target_plane());
    if (!seen) return;
    LambertSources<double> here = paper;
    Vec2d const place = seen->place;
    here.dots.centre = &place;
    auto const disc = launch.sight(here.middle(0));
    if (!disc) return;
    AimedBundle<double> const bundle = launch.bundle(*disc, {}, 0);
    double light = 0;
    for (std::uint64_t i = 0; i < launch.rays; ++i) {
      AimedRay<double> aimed = aim_ray(here, bundle, 0, i);
      RayAccount<double> account{aimed.weight};
      carry(camera, 0, camera.count, aimed.ray, account);
      light += account.weight;
    }
    double const area = 1 / std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x);
    lattice(column, row) = light * launch.light_per_weight(area);
  });
  Image<double> white(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double const u = (nodes - 1.0) * column / std::max(1, columns - 1);
      double const v = (nodes - 1.0) * row / std::max(1, rows - 1);
      int const i = std::min(static_cast<int>(u), nodes - 2), j = std::min(static_cast<int>(v), nodes - 2);
      double const fu = u - i, fv = v - j;
      white(column, row) = (1 - fv) * ((1 - fu) * lattice(i, j) + fu * lattice(i + 1, j)) +
                           fv * ((1 - fu) * lattice(i, j + 1) + fu * lattice(i + 1, j + 1));
    }
  }
  return white;
}

}  // namespace gladstone::inline rays
