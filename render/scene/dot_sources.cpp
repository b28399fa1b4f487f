#include "render/scene/scene.h"
#include "render/scene/source_kind.h"
#include "render/scene/source_sample.h"

namespace gladstone::inline scene {
namespace {

std::vector<MemoryRequirement> dot_memory(Setup const& setup) {
  constexpr double bytes_per_dot = 200;
  return {{"target.dots_per_32px_window", "dots",
           setup.target.kind == TargetKind::dots ? setup.dot_count() * bytes_per_dot : 0.0}};
}

void add_dots(Scene& scene) { scene.dots = build_target(scene.setup); }

std::size_t count_dots(Scene const& scene) { return scene.dots.centre.size(); }

Vec3d place_of_dot(Scene const& scene, std::size_t dot, std::size_t /*frame*/) {
  return {scene.dots.centre[dot].x, scene.dots.centre[dot].y, -scene.setup.z_d};
}

bool is_dot_in_view(Scene const& scene, std::size_t dot) { return scene.in_view(scene.dots.centre[dot]); }

std::size_t retain_dots(Scene& scene, std::function<bool(Vec2d pixel)> const& near) {
  std::vector<std::size_t> retained;
  for (std::size_t i = 0; i < scene.dots.centre.size(); ++i) {
    if (near(scene.to_pixel(scene.dots.centre[i]))) retained.push_back(i);
  }
  scene.dots = select_dots(scene.dots, retained);
  return retained.size();
}

}  // namespace

constinit SourceKind const dot_sources{.one = "dot",
                                       .many = "dots",
                                       .seed_table = "target",
                                       .on_target = true,
                                       .in_photons = false,
                                       .memory = dot_memory,
                                       .add = add_dots,
                                       .count = count_dots,
                                       .place = place_of_dot,
                                       .in_view = is_dot_in_view,
                                       .retain = retain_dots};

}  // namespace gladstone::inline scene
