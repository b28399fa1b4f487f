#pragma once

#include "render/scene/renderer.h"

namespace gladstone {

/// The scene as its second pulse sees it: with its second medium as the only one. @pre scene.second_medium
Scene at_second_pulse(Scene const& scene);

/// Traces particles whose second pulse sees another medium: by any renderer, through either medium, of which the first
/// gives the first pulse and the second the second. Both use the same random keys.
///
/// The places of a pulse in different media are not wrong by the same, as they nearly are in one. The standard error
/// of a displacement is that of the scatter of `sampled` particles over four keys, the same for all.
/// @pre scene.second_medium
Rendering render_in_two_media(Renderer& renderer, Scene& scene, Particles const& particles, ParticleLight light,
                              RenderImages images);

}  // namespace gladstone
