#pragma once

#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/focused_dots/bench_theory.h"
#include "render/focused_dots/cone_integral.h"

/// Kernel launches for dots. All pointers in models, media and dots are device addresses. A launch processes `count`
/// consecutive dots. Sums over a dot have a fixed order, and light is accumulated in whole units, so that results are
/// bitwise the same for any number of blocks.
namespace gladstone::cuda::inline focused_dots {

/// Ray statistics over all dots of a rendering.
struct RayTally {
  unsigned long long statuses[frame_count][ray_status_count];
  unsigned long long largest_aim_distance;  ///< largest distance of an aim point from the axis [m], as the bit pattern
                                            ///< of a double: for numbers that are not negative, the patterns have the
                                            ///< same order as the numbers, so that an integer maximum suffices
};

/// Aims at the dots and traces their check rays, one warp per dot. @param found  output: errors and ray counts
void check_dots(DotModel const& model, DeviceMedium const& medium, SourcesView<double> const& dots, std::uint64_t count,
                DotCone* cones, DotFound* found, RayTally* tally);

/// Integrates the ray cones of the dots to obtain the truth, one block per dot.
void integrate_cones(DotModel const& model, std::uint64_t count, DotCone* cones, DotFound* found);

/// Computes the images of a model's moments. @pre model.moment_images exist. @param out  output: all images
void make_moment_images(DotModel const& model, double* out);

/// Accumulates the light of the dots in both frames, one block per dot.
void expose_dots(DotModel const& model, std::uint64_t count, DotCone const* cones, DeviceImages const& images);

/// Integrates the density gradient along the straight rays of the dots, for the small-angle theory.
void integrate_theory(DotModel const& model, TheoryModel const& theory, DeviceMedium const& medium,
                      SourcesView<double> const& dots, std::uint64_t count, DotTheory* out);

}  // namespace gladstone::cuda::inline focused_dots
