#pragma once

#include <vector>

#include "render/light/particles.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Whether light of each particle can reach the sensor or its neighbourhood at either pulse. A particle is left out
/// only if its image, at both pulses, lies farther from the sensor than the sum of
/// - the first interrogation window, whose truth may be asked for (Setup::view_margin_px),
/// - its disc of confusion, by rays to the rim of the stop without the medium, half as wide again, and the spot,
/// - the medium's displacement: twice what moves a point of the object plane as far as the medium moves the probing
///   rays on the lens plane (Scene::pupil_margin). A ray that the medium turns by an angle moves by that angle times
///   the way to the lens there, but by the angle times the shorter way back to the particle in the image,
/// - 16 px.
/// Through lenslets all count.
/// @param scene planned: step and pupil margin are known
std::vector<char> particles_near_view(Scene const& scene, Particles const& particles);

}  // namespace gladstone
