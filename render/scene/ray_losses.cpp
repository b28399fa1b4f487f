#include "render/scene/ray_losses.h"

#include <map>
#include <mutex>
#include <optional>
#include <type_traits>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/optics/ray_bundle.h"
#include "render/scene/source_sample.h"

namespace gladstone::inline scene {
namespace {

constexpr std::size_t sampled_sources = 32;
constexpr int sampled_rays = 256;

/// Indices of the elements, including the medium, and of the sensor along the light path.
struct Places {
  int medium, sensor;

  explicit Places(CameraView<double> const& camera) : medium(camera.before_medium), sensor(camera.count + 1) {}
  int of_element(int i) const { return i < medium ? i : i + 1; }
};

struct End {
  int place;
  RayStatus cause;
  auto operator<=>(End const&) const = default;
};

/// Returns the element at which a ray ends before the sensor's plane, and the cause; nullopt if it reaches the plane.
template <class Medium>
std::optional<End> end_of(CameraView<double> const& camera, Medium const& medium, TracingOptions<double> const& options,
                          Ray<double> ray) {
  Places const places(camera);
  RayAccount<double> account{1.0};
  auto const passes = [&](int first, int last) -> std::optional<End> {
    for (int i = first; i < last; ++i) {
      RayStatus const status = pass_element(camera.elements[i], ray, account);
      if (status != RayStatus::alive) return End{places.of_element(i), status};
    }
    return std::nullopt;
  };
  if (auto const end = passes(0, camera.before_medium)) return end;
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    MediumPassage<double> const way = trace_medium(medium, options, ray);
    if (way.status != RayStatus::alive) return End{places.medium, way.status};
    ray = outgoing_ray(ray, way);
  }
  if (auto const end = passes(camera.before_medium, camera.count)) return end;
  Vec2d place;
  if (!camera.sensor.meet(ray, place)) return End{places.sensor, RayStatus::missed_lens};
  return std::nullopt;
}

/// Returns the names of the elements, including the medium, and of the sensor.
std::vector<std::string> names_of(Scene const& scene) {
  std::vector<std::string> names = scene.camera.names;
  names.insert(names.begin() + scene.camera.before_medium, "medium");
  names.emplace_back("sensor");
  return names;
}

}  // namespace

RayLosses sample_ray_losses(Scene const& scene, RenderPlan const& plan) {
  std::vector<std::size_t> const sources =
      scene.source_count() > 0 ? choose_sample(sources_in_view(scene, all_sources(scene)), sampled_sources)
                               : std::vector<std::size_t>{};
  CameraView<double> const camera = scene.camera.view();
  TracingOptions<double> const options{plan.step, scene.setup.medium.ambient_refractivity(),
                                       scene.setup.medium.integrator, scene.setup.medium.faces};
  RayLosses losses;
  losses.rays = scene.camera.chief_rays_only() ? 1 : static_cast<std::size_t>(sampled_rays);
  std::map<End, std::array<std::size_t, frame_count>> counts;
  std::mutex merge;
  auto const follow = [&](std::size_t frame, auto const& place_of, auto const& medium) {
    parallel_for(sources.size(), [&](std::size_t i) {
      Vec3d const start = place_of(sources[i]);
      auto const disc = scene.camera.apparent_pupil(start);
      if (!disc) return;
      std::map<End, std::size_t> ended;
      for (std::size_t k = 0; k < losses.rays; ++k) {
        throw_if_interrupted();
        Vec2d const at =
            losses.rays == 1 ? Vec2d{} : sunflower(static_cast<int>(k), sampled_rays) / Camera::pupil_safety_factor();
        Vec3d const aim = disc->centre + at.x * disc->a + at.y * disc->b;
        if (auto const end = end_of(camera, medium, options, {start, normalized(aim - start)})) ++ended[*end];
      }
      std::lock_guard const lock(merge);
      if (frame == 0) ++losses.sources;
      for (auto const& [end, count] : ended) counts[end][frame] += count;
    });
  };
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    auto const place_of = [&](std::size_t source) { return scene.source_place(source, frame); };
    if (frame == 0 && !scene.setup.experiment().medium_in_first_frame) {
      follow(frame, place_of, NoMedium<double>{});
    } else {
      BuiltMedium const& medium = frame == 1 && scene.second_medium ? *scene.second_medium : scene.medium;
      std::visit([&](auto const& view) { follow(frame, place_of, view); }, medium.view);
    }
  }
  std::vector<std::string> const names = names_of(scene);
  double const all = static_cast<double>(losses.sources * losses.rays);
  for (auto const& [end, count] : counts) {
    ElementRayLoss& lost = losses.lost.emplace_back();
    lost.place = names.at(static_cast<std::size_t>(end.place));
    lost.cause = end.cause;
    for (std::size_t frame = 0; frame < frame_count; ++frame)
      lost.share[frame] = static_cast<double>(count[frame]) / all;
  }
  return losses;
}

}  // namespace gladstone::inline scene
