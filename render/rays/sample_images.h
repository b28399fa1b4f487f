#pragma once

#include <cstddef>
#include <vector>

#include "render/scene/renderer.h"

/// Images of a sample of a scene's sources by the general renderer on the CPU: the exposure before a rendering, and the
/// error of its images afterwards.
namespace gladstone::inline rays {

/// Number of rays of the sources of a sample.
enum class SampleRays {
  required,   ///< numbers as in a rendering of the scene
  next_rule,  ///< numbers of the next finer rule, where rays are sent to the nodes of a cubature rule (stop_rule.h)
};

/// Images of up to 96 sources, spread evenly over those in view.
struct SampleImages {
  FramePair<double> light;
  double share = 1;        ///< number of sources in view per source of the sample
  bool next_rule = false;  ///< true: rendered with the next finer rule
};
/// Renders a sample of some sources of a scene, dots as bright dots.
/// @param sources  indices of the sources
SampleImages render_sample(Scene const& scene, RenderPlan const& plan, std::vector<std::size_t> const& sources,
                           SampleRays rays = SampleRays::required);

/// Estimates the light of the brightest pixel of both images of all sources: that of the sample, or the mean plus three
/// standard deviations of the light of randomly overlapping sources (Campbell's theorem).
double brightest_pixel(SampleImages const& sample);

/// Measures the standard error of the images of sources of a scene that were rendered by the general renderer: rms over
/// lit pixels of the worse image. A sample is rendered twice with the rays of the plan and independent scramblings;
/// half of the mean square of the differences is the variance of one rendering. A cubature rule has an error that is
/// common to all scramblings, its rotations; it is therefore compared with the next finer rule, and the whole mean
/// square is the variance.
/// @param level    light of one grey level
/// @param sources  indices of the sources
/// @return error [grey levels]; NaN if no pixel is lit
double measure_image_error(Scene const& scene, RenderPlan const& plan, double level,
                           std::vector<std::size_t> const& sources);

}  // namespace gladstone::inline rays
