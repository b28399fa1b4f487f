#pragma once

#include <cstddef>
#include <vector>

#include "render/base/random.h"
#include "render/light/flow_path.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_setup.h"
#include "render/light/particles.h"

/// Steps of seeding and moving particles that pairs and sequences have in common.
namespace gladstone::inline light {

/// Returns the velocity of particles of a diameter [m] in the flow, with their lag.
ParticleVelocity particle_velocity(ParticleSetup const& setup, FlowSetup const& flow, double diameter);

/// Chooses the number of integration steps for all particles from a sample of them, spread evenly over the list.
/// @param time       duration of the paths [s]
/// @param tolerance  maximum change of a final position when the step is halved [m]
PathPlan plan_paths(ParticleSetup const& setup, FlowSetup const& flow, std::vector<Vec3d> const& start,
                    std::vector<double> const& diameter, double time, double tolerance);

/// Returns true if a position [m] is in the seeded volume, or if the volume is unlimited.
bool is_inside_volume(ParticleSetup const& setup, Vec3d place);

/// Computes the photons per area incident on every particle at both pulses.
void light_particles(ParticleSetup const& setup, LaserSheet<double> const& sheet, Particles& particles);

/// Returns the number of candidate positions per particle for rejection sampling of a non-uniform number density.
double draws_per_particle(ParticleSetup const& setup, FlowSetup const& flow);

/// Returns true if a candidate particle is accepted, with a probability proportional to the number density at its
/// position (rejection sampling).
bool crowds_here(Flow const& flow, Vec3d place, double tau, KeyedEngine& engine);

/// Counts the particles that are outside the velocity field of a file at either pulse.
std::size_t count_outside(FlowSetup const& flow, Particles const& particles);

}  // namespace gladstone::inline light
