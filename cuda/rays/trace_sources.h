#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/rays/aimed_sources.h"
#include "render/rays/hit_spline.h"
#include "render/scene/spot.h"
#include "render/scene/truth_error.h"

namespace gladstone::cuda {

/// Rays of a source that one block traces; sources of more rays are shared between several.
inline constexpr std::uint64_t most_rays_a_share = 16384;

/// The widest window that any source has, in nodes, and what a block may take of shared memory for it: so much has
/// every card since 2020. A card with less lays every ray down by itself.
inline constexpr int most_window_nodes = 88;
inline constexpr std::size_t most_block_bytes = 96 * 1024;

/// How the rays of a source are sent, and where most of their light is expected.
struct SourceOnDevice {
  std::uint64_t source;                               ///< by its number in the pattern
  Vec3d centre, a, b, across;                         ///< as AimedBundle
  Vec2d origin;                                       ///< that its sums count from [px]
  int window_px = 0;                                  ///< side of the windows that its light is gathered in; 0: none
  int left[frame_count] = {}, top[frame_count] = {};  ///< pixel of the first node of either frame's
  double most_weight = 0;                             ///< of a ray that a window takes; others are laid down one by one
};

/// What all sources of a launch share.
struct SourcesLaunch {
  static constexpr std::size_t windows = frame_count;  ///< of a block: one a frame

  CameraView<double> camera;  ///< its elements on the device
  TracingOptions<double> tracing;
  LambertSources<double> sources;  ///< on the device
  BundleView<double> choice;
  SpotView spot;
  HitSplineView spline;    ///< on the device; no share: rays are laid down one by one
  int most_window_px = 0;  ///< of the sources
  DeviceImages images;     ///< may be none
  std::uint64_t rays = 1;
  double sign = 1;  ///< of the light that is laid down

  int scramblings() const { return 1 << choice.scrambling_bits; }
  std::uint64_t shares() const { return (rays + most_rays_a_share - 1) / most_rays_a_share; }
};

/// What a launch gives, on the device.
struct SourcesTraced {
  RaySums* sums;             ///< [source][share][scrambling]
  double* moved2;            ///< [source]: square of the furthest that the medium moved a ray [m^2]
  unsigned long long* ends;  ///< [frame][status], counted on
};

/// The widest window that sources of a launch may have [px]: not of any one of them, so that none depends on others.
int widest_window_px(SourcesLaunch const& launch, DeviceMedium<double> const& medium);

/// Traces all rays of `count` sources in both frames, a block for each share of a source: sums, ends, light. Sums have
/// an order and light is in whole units, so that results hang on nothing but the source.
/// @param sources on the device
void trace_sources(SourcesLaunch const& launch, DeviceMedium<double> const& medium, SourceOnDevice const* sources,
                   std::uint64_t count, SourcesTraced const& traced);

}  // namespace gladstone::cuda
