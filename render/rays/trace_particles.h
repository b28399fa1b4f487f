#pragma once

#include "render/light/lambert_sphere.h"
#include "render/rays/particle_sources.h"
#include "render/rays/particle_tracer.h"
#include "render/scene/renderer.h"

namespace gladstone::inline rays {

/// Calls visit(pulses, medium) with the ParticleSources of both pulses, whose type depends on the scattering, and with
/// the medium.
template <class Visit>
auto with_particles(Scene const& scene, Particles const& particles, ParticleLight light, Visit&& visit) {
  LaserSheet<double> const sheet = laser_sheet(scene.setup.piv->laser);
  auto const with = [&]<class Scattering>(Scattering const& scattering) {
    ParticleSources<double, Scattering> pulses[frame_count];
    for (int frame = 0; frame < frame_count; ++frame) {
      pulses[frame] = {particles.place[frame].data(), particles.photons[frame].data(), scattering, sheet, frame};
    }
    return std::visit([&](auto const& medium) { return visit(pulses, medium); }, scene.medium.view);
  };
  if (light == ParticleLight::equal) return with(EqualSpheres<double>{});
  if (scene.mie) return with(scene.mie->view());
  return with(LambertSpheres<double>{particles.diameter.data()});
}

/// Returns a rendering of particles whose truth is allocated but not computed.
Rendering empty_rendering(Particles const& particles);

/// Stores the truth of a particle.
/// @param rays  number of its rays at each pulse
void set_particle(GroundTruth& truth, std::size_t particle, TracedParticleTruth const& seen, std::uint64_t rays);

/// Sums up the rays of all particles.
void count_rays(Rendering& rendering);

/// Renders images and truth of particles by ray tracing. Light is in units of photon_unit(), the truth's flux in
/// photons.
Rendering trace_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles, ParticleLight light,
                          RenderImages images);

}  // namespace gladstone::inline rays
