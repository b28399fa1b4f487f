#pragma once

#include <cstdint>

#include "cuda/focused_dots/trace_rays.h"
#include "render/focused_dots/dot_light.h"

namespace gladstone::cuda {

/// What is known of a dot's light once its rays are summed up; stays on the device.
struct DotCone {
  DotKind kind;
  Vec2d origin;       ///< mean displacement of the traced rays [px]
  MomentField field;  ///< of a narrow one
  TableCheck check;   ///< of a wide one
};

/// Images in the making: 64-bit fixed point, row by row.
struct DeviceImages {
  unsigned long long* light[frame_count] = {};  ///< null: no images
  int columns = 0;
  int rows = 0;
  double units_per_weight = 0;  ///< units of fixed point
};

/// Sums up the records of a batch's dots to truth, a block a dot: truth[i] and cones[i] belong to dot first + i.
/// The same bits on any number of blocks: a dot's sums have one order.
/// @param cones null: no images
template <class T>
void sum_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
              RayRecord<T> const* records, DotTruth* truth, DotCone* cones);
extern template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*,
                              DotTruth*, DotCone*);
extern template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*,
                              DotTruth*, DotCone*);

/// Works out the images of a model's moments, which have a plan. @param out room for them on the device
void make_moment_images(LightModel const& model, double* out);

/// Lays down the light of still and narrow dots. Images add up in fixed point, in any order.
void expose_cones(LightModel const& model, SourcesView<double> const& sources, Batch const& batch, DotCone const* cones,
                  DeviceImages const& images);

/// Lays down the light of all others.
template <class T>
void expose_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
                 RayRecord<T> const* records, DotTruth const* truth, DotCone const* cones, DeviceImages const& images);
extern template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*,
                                 DotTruth const*, DotCone const*, DeviceImages const&);
extern template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*,
                                 DotTruth const*, DotCone const*, DeviceImages const&);

/// Turns fixed point into light per pixel. @param light count doubles on the device
void to_light(unsigned long long const* fixed_point, double* light, std::size_t count);

}  // namespace gladstone::cuda
