#pragma once

#include <cstdint>

#include "cuda/trace_rays.h"
#include "render/scene/dot_light.h"

namespace gladstone::cuda {

/// What one dot's rays come to.
struct DotSums {
  Vec2d origin;  ///< that the sums' places count from [px]
  CentroidSum<double> hits[frame_count];
};

/// Images in the making: 64-bit fixed point, row by row.
struct DeviceImages {
  unsigned long long* light[frame_count] = {};  ///< null: no images
  int columns = 0;
  int rows = 0;
  double light_per_weight = 0;
};

/// Sums up the records of a batch's dots, a block a dot, and lays down their light. sums[i] belongs to dot first + i.
/// The same bits on any number of blocks: a dot's sums have one order, and images add up in fixed point.
template <class T>
void expose_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
                 RayRecord<T> const* records, DeviceImages const& images, DotSums* sums);
extern template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*,
                                 DeviceImages const&, DotSums*);
extern template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*,
                                 DeviceImages const&, DotSums*);

/// Turns fixed point into light per pixel. @param light count doubles on the device
void to_light(unsigned long long const* fixed_point, double* light, std::size_t count);

}  // namespace gladstone::cuda
