#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/scene/ray_hit.h"
#include "render/scene/scene.h"

/// Where the rays of a scene's sources end that do not reach its sensor's plane, by a sample of them: renderers count
/// rays by cause alone.
namespace gladstone {

/// Rays that ended at one place for one cause.
struct RaysLostAt {
  std::string place;  ///< "surface 3" of a prescription, counted from 1 as `gladstone info lens` counts, "stop", "thin
                      ///< lens", "window 1, first face", "lenslets", "medium", "sensor"
  RayStatus cause;
  std::array<double, frame_count> share;  ///< of all that were sent, in each frame [1]
};

/// A sample of a scene's rays.
struct RayLosses {
  std::size_t sources = 0;       ///< that were looked at, spread over those in view
  std::size_t rays = 0;          ///< of each
  std::vector<RaysLostAt> lost;  ///< in the order that light meets the places
};

/// Follows rays from the middles of up to 32 sources in view, 256 of each, which fill what the source sees of the stop
/// without the medium: all of them would pass, were it not for other edges, what lies beside an aberrated pupil's rim,
/// and the medium, which bends some past the stop (and others, not sent here, into it). Of a camera without a stop one
/// ray of each.
RayLosses sample_ray_losses(Scene const& scene);

}  // namespace gladstone
