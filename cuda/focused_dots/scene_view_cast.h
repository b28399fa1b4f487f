#pragma once

#include "cuda/device/scalar_cast.h"
#include "render/focused_dots/scene_view.h"

/// A scene's view in another scalar. One function for every element.
namespace gladstone::cuda {

template <class T>
ApertureStop<T> cast(ApertureStop<double> const& stop) {
  return {static_cast<T>(stop.z), static_cast<T>(stop.radius), static_cast<T>(stop.edge)};
}
template <class T>
ThinLens<T> cast(ThinLens<double> const& lens) {
  return {static_cast<T>(lens.z), static_cast<T>(lens.focal_length)};
}

/// All but the sources, whose arrays the caller holds.
template <class T>
SceneView<T> cast(SceneView<double> const& view) {
  SceneView<T> other;
  other.sources.count = view.sources.count;
  other.sources.plane_z = static_cast<T>(view.sources.plane_z);
  other.sources.half_size = static_cast<T>(view.sources.half_size);
  other.sources.shape = view.sources.shape;
  other.bundle = {static_cast<T>(view.bundle.lens_z), static_cast<T>(view.bundle.pupil_radius), view.bundle.seed,
                  view.bundle.sampling, view.bundle.scrambling_bits};
  for (int i = 0; i < view.train.count; ++i) {
    view.train.elements[i].visit([&](auto const& element) { other.train.append(cast<T>(element)); });
  }
  other.sensor = {static_cast<T>(view.sensor.z), static_cast<T>(view.sensor.pitch), view.sensor.columns,
                  view.sensor.rows};
  other.tracing = {static_cast<T>(view.tracing.step), static_cast<T>(view.tracing.ambient_refractivity),
                   view.tracing.integrator, view.tracing.faces};
  return other;
}

}  // namespace gladstone::cuda
