#pragma once

#include <vector>

#include "render/light/particles.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Whether light of each particle can reach the sensor or its neighbourhood at either pulse. A particle is left out
/// only if its image, at both pulses, lies farther from the sensor than the sum of
/// - the first interrogation window, whose truth may be asked for (Setup::view_margin_px),
/// - its disc of confusion, by rays to the rim of the stop without the medium, half as wide again, and the spot,
/// - the medium's displacement: that of the probing rays on the lens plane (Scene::pupil_margin) times twice the
///   ratio of the longest way back to a particle and the shortest way on to the lens, from any place in the medium, and
///   twice at most. A turn by an angle moves the image by the former way and the ray at the lens by the latter,
/// - 8 px.
/// Through lenslets all count.
/// @param scene planned: step and pupil margin are known
std::vector<char> particles_near_view(Scene const& scene, Particles const& particles);

}  // namespace gladstone
