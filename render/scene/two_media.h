#pragma once

#include "render/scene/renderer.h"

namespace gladstone::inline scene {

/// Returns the scene with its first medium as its only one, as seen by the first pulse.
Scene select_first_pulse(Scene const& scene);

/// Returns the scene with its second medium as its only one, as seen by the second pulse.
/// @pre scene.second_medium
Scene select_second_pulse(Scene const& scene);

/// Renders particles with a different medium at each pulse: renders each medium separately with the same random keys,
/// and takes frame A from the first and frame B from the second.
///
/// Errors of image positions in different media do not cancel in the displacement, as they nearly do in a single one.
/// The standard error is estimated from the scatter of up to 256 particles over four random keys, and is the same for
/// all particles. It is not estimated (NaN) if no images are rendered.
/// @pre scene.second_medium
Rendering render_in_two_media(Renderer& renderer, Scene const& scene, RenderPlan const& plan,
                              Particles const& particles, ParticleLight light, RenderImages images);

}  // namespace gladstone::inline scene
