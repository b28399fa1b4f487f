#pragma once

#include "render/focused_dots/focused_dots.h"
#include "render/scene/ray_plan.h"

/// The plans of ray_plan.h for focused dots, by the rays and the light of the fast renderer. The scene stays as it is.
namespace gladstone {

/// choose_step(), dots being probed by five rays shared by all steps (pupil centre and four points of its rim). Of a
/// target with more than 256 dots those 256 are probed whose chief rays change most when the first step is halved.
StepPlan plan_step(FocusedDots const& dots);

/// Errors at the scene's present number of rays: how far independent scramblings of it scatter on a sample of up to 96
/// dots spread over the target, each traced four times. Images as they are where dots overlap: pixels that several dots
/// light have the sum of their variances, and "auto" exposes for the brightest pixel that dots at random make. To
/// truth's scatter comes what a deflection table leaves of every ray alike: up to 24 dots are traced by 4096 to 65,536
/// rays each without it. Of images scatter is all that is measured: a table leaves a third of a grey level of 12 bits
/// more, and 2 to 8 levels where fronts spread a dot's rays over pixels.
RaysPlan measure_rays(FocusedDots const& dots);

/// choose_rays() by measure_rays().
RaysPlan plan_rays(FocusedDots const& dots);

}  // namespace gladstone
