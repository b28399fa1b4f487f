#pragma once

#include <cstdint>

#include "cuda/rays/device_medium.h"
#include "render/focused_dots/dot_light.h"
#include "render/focused_dots/ray_record.h"
#include "render/scene/ground_truth.h"

/// Launches over rays: TracePair and the theory, for any medium.
namespace gladstone::cuda {

/// Dots [first, first + dots) with `rays` rays each: what one launch works on.
struct Batch {
  std::uint64_t first = 0;
  std::uint64_t dots = 0;
  std::uint64_t rays = 0;
};

/// Counted over all rays of a rendering, on the device.
struct TraceTally {
  unsigned long long statuses[2][ray_status_count];
  unsigned long long largest_bend2;  ///< bits of a double, which order as the numbers do [m^2]
};

/// Traces the batch's rays through both frames; ray j of its dot i leaves records[i * rays + j]. All pointers of the
/// view and of the medium are the device's.
template <class T>
void trace_rays(SceneView<T> const& view, DeviceMedium<T> const& medium, TargetImage const& image, Batch const& batch,
                RayRecord<T>* records, TraceTally* tally);
extern template void trace_rays(SceneView<double> const&, DeviceMedium<double> const&, TargetImage const&, Batch const&,
                                RayRecord<double>*, TraceTally*);
extern template void trace_rays(SceneView<float> const&, DeviceMedium<float> const&, TargetImage const&, Batch const&,
                                RayRecord<float>*, TraceTally*);

/// What theory needs of one dot.
struct DotTheory {
  GradientIntegral<double> along;
  ConeSum cone;
};

/// Integrates the gradient along the straight rays of the batch's dots: out[i] belongs to dot first + i.
void integrate_dots(LightModel const& light, TheoryModel const& model, SceneView<double> const& view,
                    DeviceMedium<double> const& medium, Batch const& batch, DotTheory* out);

}  // namespace gladstone::cuda
