#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/rays/aimed_sources.h"
#include "render/rays/hit_spline.h"
#include "render/scene/spot.h"
#include "render/scene/truth_error.h"

namespace gladstone::cuda::inline rays {

/// Maximum number of rays of a source traced by one block; larger numbers are divided among several blocks.
inline constexpr std::uint64_t max_rays_per_share = 16384;

/// Maximum side of a source's window in spline nodes, and shared memory of a block for it, which all cards since 2020
/// provide. On cards with less, the PSFs of rays are added one by one.
inline constexpr int most_window_nodes = 88;
inline constexpr std::size_t most_block_bytes = 96 * 1024;

/// Data of one source for its rays: bundle of rays, and window of the sensor on which their light is expected.
struct SourceOnDevice {
  std::uint64_t source;                               ///< index of the source in the pattern
  Vec3d centre, a, b, across, by_x, by_y;             ///< target area and its shift, as in AimedBundle
  Vec2d origin;                                       ///< reference point on the sensor of the sums over the rays [px]
  int window_px = 0;                                  ///< side of the windows of spline nodes (HitWindow) that
                                                      ///< accumulate its light; 0: none
  int left[frame_count] = {}, top[frame_count] = {};  ///< pixel of the window's first node in each frame
  double most_weight = 0;  ///< maximum weight of a ray that its HitWindow can accumulate in integers; the PSFs of
                           ///< heavier rays are added directly to the image
};

/// Data common to all sources of a launch.
struct SourcesLaunch {
  static constexpr std::size_t windows = frame_count;  ///< number of windows of spline nodes (HitWindow) per block: one
                                                       ///< per frame

  CameraView<double> camera;  ///< camera with its elements in device memory
  TracingOptions<double> tracing;
  LambertSources<double> sources;  ///< sources in device memory
  BundleView choice;
  SpotView spot;
  HitSplineView spline;    ///< weights of the spline in device memory; null share: PSFs are added one by one
  int most_window_px = 0;  ///< maximum side of the sources' windows of spline nodes [px]
  DeviceImages images;     ///< images to which light is added; may be empty
  std::uint64_t rays = 1;
  double sign = 1;  ///< sign of the light

  int scramblings() const { return 1 << choice.scrambling_bits; }
  std::uint64_t shares() const { return (rays + max_rays_per_share - 1) / max_rays_per_share; }
};

/// Output of a launch, in device memory.
struct SourcesTraced {
  RaySums* sums;             ///< sums over the rays, [source][share][scrambling]
  double* moved2;            ///< [source]: largest squared displacement of a ray by the medium [m^2]
  unsigned long long* ends;  ///< ray counts to be incremented: [frame][status]
};

/// Returns the maximum side of windows [px]. It does not depend on the sources, so that the result of one is
/// independent of the others.
int widest_window_px(SourcesLaunch const& launch, DeviceMedium const& medium);

/// Traces all rays of `count` sources in both frames, one block per share of a source. Adds their light, sums and
/// status counts. Sums have a fixed order and light is in whole units, so that the result of a source is independent of
/// the others.
/// @param sources  in device memory
void trace_sources(SourcesLaunch const& launch, DeviceMedium const& medium, SourceOnDevice const* sources,
                   std::uint64_t count, SourcesTraced const& traced);

}  // namespace gladstone::cuda::inline rays
