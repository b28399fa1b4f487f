#pragma once

#include <vector>

#include "render/light/particles.h"
#include "render/scene/render_plan.h"

namespace gladstone::inline rays {

/// Returns, for each particle, whether its light can reach the sensor or its neighbourhood at either pulse.
/// A particle is excluded only if at both pulses it is not illuminated or its image is farther from the sensor than the
/// sum of
/// - the first interrogation window, for which the truth may be requested (Setup::view_margin_px),
/// - its circle of confusion, from rays to the edge of the stop without medium, times 1.5, and the half width of the
///   PSF,
/// - the displacement by the medium: the largest deflection of the probe rays on the lens plane
/// (RenderPlan::pupil_margin),
///   times twice the ratio of the longest distance from the medium back to a particle to the shortest distance on to
///   the lens, at most 2. A deflection by an angle shifts the image in proportion to the former distance and the ray at
///   the lens in proportion to the latter,
/// - 8 px.
/// If an optical element divides the light cones (lenslets), all particles are included.
std::vector<char> particles_near_view(Scene const& scene, RenderPlan const& plan, Particles const& particles);

}  // namespace gladstone::inline rays
