#pragma once

#include "render/scene/renderer.h"

/// Images of a sample of a scene's sources by the general renderer on the CPU: the exposure before a rendering, and the
/// error of its images afterwards.
namespace gladstone {

/// Number of rays of the sources of a sample.
enum class SampleRays {
  required,   ///< as in a rendering of the scene
  next_rule,  ///< where rays are sent to the nodes of a cubature rule (stop_rule.h), those of the next finer rule
};

/// Images of up to 96 sources, spread evenly over those in view.
struct SampleImages {
  FramePair<double> light;
  double share = 1;        ///< number of sources in view per source of the sample
  bool next_rule = false;  ///< the next finer rule was used
};
/// Renders a sample of the scene's sources, dots as bright dots.
/// @param scene  scene with its step and rays
SampleImages render_sample(Scene scene, SampleRays rays = SampleRays::required);

/// Estimates the light of the brightest pixel of both images of all sources: that of the sample, or the mean plus three
/// standard deviations of the light of randomly overlapping sources (Campbell's theorem).
double brightest_pixel(SampleImages const& sample);

/// Measures the standard error of the images of a scene that was rendered by the general renderer: rms over lit pixels
/// of the worse image. A sample is rendered twice with the rays of the scene and independent scramblings; half of the
/// mean square of the differences is the variance of one rendering. A cubature rule has an error that is common to all
/// scramblings, its rotations; it is therefore compared with the next finer rule, and the mean square counts in full.
/// @param level  light of one grey level
/// @return error [grey levels]; NaN if no pixel is lit
double measure_image_error(Scene const& scene, double level);

}  // namespace gladstone
