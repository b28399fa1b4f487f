#pragma once

#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/focused_dots/bench_theory.h"
#include "render/focused_dots/cone_integral.h"

/// What launches do with dots. All pointers of models, media and dots are the device's; a launch works on `count` dots
/// that lie one after the other, a dot's sums have one order, and light is in whole units: the same bits on any number
/// of blocks.
namespace gladstone::cuda {

/// Counted over all dots of a rendering, on the device.
struct RayTally {
  unsigned long long statuses[frame_count][ray_status_count];
  unsigned long long farthest_aim;  ///< bits of a double, which order as the numbers do [m]
};

/// Aims at dots and traces their rays, a warp a dot. @param found receives errors and counts of rays
void check_dots(DotModel const& model, DeviceMedium<double> const& medium, SourcesView<double> const& dots,
                std::uint64_t count, DotCone* cones, DotFound* found, RayTally* tally);

/// Integrates their cones to truth, a block a dot.
void integrate_cones(DotModel const& model, std::uint64_t count, DotCone* cones, DotFound* found);

/// Works out the images of a model's moments, which have a plan. @param out room for them
void make_moment_images(DotModel const& model, double* out);

/// Lays down the light of dots in both frames, a block a dot.
void expose_dots(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images);

/// Integrates the gradient along the straight rays of dots.
void integrate_theory(DotModel const& model, TheoryModel const& theory, DeviceMedium<double> const& medium,
                      SourcesView<double> const& dots, std::uint64_t count, DotTheory* out);

}  // namespace gladstone::cuda
