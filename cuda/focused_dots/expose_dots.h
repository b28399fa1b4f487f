#pragma once

#include <cstdint>

#include "cuda/device/device_images.h"
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

}  // namespace gladstone::cuda
