#pragma once

#include "render/scene/renderer.h"

namespace gladstone {

/// Measures the accuracy of a rendering. For the images, a sample of its sources is rendered twice
/// (measure_image_error()); the error of a deflection table is measured unless the plan contains it.
/// @param plan  plan of the rendering, with its method
/// @param truth  truth of the rendering
/// @param exposure_e  electrons per unit of light
RenderingAccuracy measure_accuracy(Scene const& scene, RenderPlan const& plan, GroundTruth const& truth,
                                   double exposure_e);

}  // namespace gladstone
