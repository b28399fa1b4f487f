#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/scene/ray_hit.h"
#include "render/scene/render_plan.h"

/// Diagnosis of ray losses: the elements at which a sample of a scene's rays is blocked or lost. Renderers count lost
/// rays by cause only.
namespace gladstone::inline scene {

/// Fraction of rays lost at one element for one cause.
struct ElementRayLoss {
  std::string place;  ///< "surface 3" of a prescription (counted from 1, as in `gladstone info lens`), "stop", "thin
                      ///< lens", name and part of another element (Camera::names), "medium" or "sensor"
  RayStatus cause;
  std::array<double, frame_count> share;  ///< fraction of all rays sent, for each image [1]
};

/// Result of sample_ray_losses().
struct RayLosses {
  std::size_t sources = 0;           ///< number of sampled sources, spread evenly over those in view
  std::size_t rays = 0;              ///< number of rays per source
  std::vector<ElementRayLoss> lost;  ///< losses in the order of the light path
};

/// Traces 256 rays from the centre of each of up to 32 sources in view and records where they are lost.
/// The rays fill the entrance pupil as seen from the source without medium. Rays are lost at other apertures, outside
/// the edge of an aberrated pupil, and where the medium deflects them past the stop; rays that the medium deflects into
/// the stop are not sampled. A camera without a stop has one ray per source.
RayLosses sample_ray_losses(Scene const& scene, RenderPlan const& plan);

}  // namespace gladstone::inline scene
