#pragma once

#include <cstdint>

#include "render/base/host_device.h"
#include "render/focused_dots/scene_view.h"
#include "render/scene/ray_hit.h"

namespace gladstone {

/// Which ray of which source.
struct RayIndex {
  std::uint64_t source;
  std::uint64_t ray;
};

/// From the target's side of the lens to the sensor's plane.
template <class T>
GLADSTONE_HD RayHit<T> through_camera(SceneView<T> const& scene, Ray<T> ray, T weight) {
  RayHit<T> hit;
  hit.weight = weight;
  T const to_lens = (scene.bundle.lens_z - ray.position.z) / ray.direction.z;
  hit.at_lens = {ray.position.x + to_lens * ray.direction.x, ray.position.y + to_lens * ray.direction.y};
  hit.status = scene.train.carry(ray, hit.weight);
  if (hit.weight == T(0)) return hit;
  T const way = (scene.sensor.z - ray.position.z) / ray.direction.z;
  hit.pixel = scene.sensor.to_pixel(ray.position.x + way * ray.direction.x, ray.position.y + way * ray.direction.y);
  if (hit.status == RayStatus::alive && !scene.sensor.covers(hit.pixel)) hit.status = RayStatus::missed_sensor;
  return hit;
}

/// From where a ray leaves the medium through the camera.
template <class T>
GLADSTONE_HD RayHit<T> after_medium(SceneView<T> const& scene, Ray<T> const& start, MediumPassage<T> const& way,
                                    T weight) {
  if (way.status != RayStatus::alive) {
    RayHit<T> lost;
    lost.status = way.status;
    return lost;
  }
  return through_camera(scene, apparent_ray(start, way), weight);
}

/// One ray in the flow frame: through the medium, then through the camera.
template <class T, class Medium>
GLADSTONE_HD RayHit<T> follow(SceneView<T> const& scene, Medium const& medium, Ray<T> const& start, T weight) {
  return after_medium(scene, start, trace_medium(medium, scene.tracing, start), weight);
}

/// The one per-ray function of the renderer, for every device: emits a ray once and follows it through both frames.
/// `Exposure` has record(emitted, reference, flow), which keeps what images and truth need.
template <class T, class Medium>
struct TracePair {
  SceneView<T> scene;
  Medium medium;

  /// N rays of a source from ray i on, side by side: faster on a processor that works ahead.
  template <int N, class Exposure>
  GLADSTONE_HD void together(RayIndex i, Exposure& exposure) const {
    EmittedRay<T> emitted[N];
    Ray<T> start[N];
    for (int k = 0; k < N; ++k) {
      emitted[k] = emit(scene.sources, scene.bundle, i.source, i.ray + static_cast<std::uint64_t>(k));
      start[k] = emitted[k].ray;
    }
    MediumPassage<T> way[N];
    trace_medium(medium, scene.tracing, start, way);
    for (int k = 0; k < N; ++k) {
      exposure.record(emitted[k], through_camera(scene, start[k], emitted[k].weight),
                      after_medium(scene, start[k], way[k], emitted[k].weight));
    }
  }
};

}  // namespace gladstone
