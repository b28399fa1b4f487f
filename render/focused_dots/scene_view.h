#pragma once

#include "render/light/sources.h"
#include "render/medium/trace_medium.h"
#include "render/optics/optical_train.h"
#include "render/sensor/sensor.h"

namespace gladstone {

/// Everything but the medium that a ray meets, by value: what a launch hands to every thread.
template <class T>
struct SceneView {
  SourcesView<T> sources;
  BundleView<T> bundle;
  OpticalTrain<T> train;
  Sensor<T> sensor;
  TracingOptions<T> tracing;
};

}  // namespace gladstone
