#pragma once

#include <vector>

#include "render/scene/renderer.h"
#include "render/scene/scene.h"
#include "render/scene/setup.h"

namespace gladstone::inline cases {

/// Expected cost of rendering a setup, estimated without reading fields or tracing rays.
struct RenderCost {
  RenderMethod method = RenderMethod::automatic;
  double sources = 0;             ///< number of dots (of all planes) or particles in the sheet; NaN: unknown
  double rays_per_source = 0;     ///< number of rays per source: configured, or the largest that "auto" may choose
  bool rays_are_largest = false;  ///< true: rays_per_source is an upper limit
  double expected_rays = 0;       ///< number of rays that most particles require (PIV with "auto"); otherwise
                                  ///< rays_per_source
  double processor_seconds = 0;   ///< time on one core of the processor of docs/performance.md [s]; NaN: unknown
  double expected_seconds = 0;    ///< processor time for the expected number of rays [s]
  std::vector<MemoryRequirement> memory;

  double seconds() const;          ///< expected wall time on the threads of this process, without preparation [s]
  double longest_seconds() const;  ///< expected wall time for the largest number of rays [s]
  double bytes() const;            ///< sum of `memory` [bytes]
};

/// Estimates the cost. The time is proportional to that of render_seconds() for the coarsest integration step and the
/// rays of the setup, with a factor that was measured for each method; for "auto", the largest number of rays that may
/// be chosen (focused_dots: the smallest), and for PIV also the number that the blur of the particle images at the edge
/// of the laser sheet requires. The field of a file is replaced by a medium of the same depth, length scale and number
/// of steps, which are read from the file's header.
/// @throws DataError if a file cannot be read
RenderCost estimate_render_cost(Setup const& setup);

/// Estimates the processor time for rendering a scene by a plan as estimate_render_cost() does [s]; for adaptive ray
/// numbers of particles with the number of rays that it expects.
double expected_render_seconds(Scene const& scene, RenderPlan const& plan, RenderTheory theory);

}  // namespace gladstone::inline cases
