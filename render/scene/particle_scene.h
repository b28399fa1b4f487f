#pragma once

#include <string>
#include <vector>

#include "render/light/mie_scattering.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Particles that a PIV setup has in its volume at a time, on average. For per_pixel the volume's share that the camera
/// sees is found by the chief rays of 16384 places in it, to about 0.1 %. @pre setup.piv, without a file of particles
double particle_count(Setup const& setup);

/// Memory that the particles of a setup take, and the key of [particles] that says how many.
MemoryNeed particle_memory(Setup const& setup);

/// Puts particles, their scattering and the unit of light into a scene whose camera stands.
/// @throws DataError where no particle is lit
void add_particles(Scene& scene);

/// What a particle sends through the lens, by its light into the middle of the lens.
class LightThroughLens {
 public:
  /// The scene must outlive it. @param light as it scatters the laser's, or alike into all directions
  explicit LightThroughLens(Scene const& scene, ParticleLight light = ParticleLight::scattered);

  /// Photons through the lens from a place [m], over those per area that light the particle there [m^2].
  double operator()(Vec3d place, std::size_t particle, int pulse) const;

 private:
  double cross_section(Vec3d place, Vec3d direction, std::size_t particle, int pulse) const;

  Scene const& scene_;
  ParticleLight light_;
  LaserSheet<double> sheet_;
  MieScatteringView<double> mie_;
};

/// Photons that a particle sends through the lens at a pulse.
double photons_through_lens(Scene const& scene, std::size_t particle, int pulse);

/// Photons through the lens from the one of these particles that sends most; 0 where none is lit.
double brightest_photons(Scene const& scene, Particles const& particles, ParticleLight light);

/// Photons that light of 1 stands for in pictures of these particles: scene.photon_unit of what the laser lights. Equal
/// light is brighter by what a sphere is smaller than a square metre, 1e12 and more, which the pictures' fixed point
/// does not hold: it has a unit of its own, the brightest of these particles.
double photon_unit(Scene const& scene, Particles const& particles, ParticleLight light);

/// Most electrons that light of 1 can set free: its photons times the quantum efficiency, where the sensor has noise.
/// Infinite without noise, whose full well is only the scale of grey levels, and for BOS, whose light has no photons.
double photon_limited_exposure(Scene const& scene);

/// Displacements that correlation resolves at best; smaller ones are warned of [px].
inline constexpr double measurable_displacement_px = 0.01;

/// What the warnings of a PIV case rest on.
struct ParticleCensus {
  std::size_t lit[2] = {0, 0};  ///< particles in volume and sheet at either pulse
  std::size_t in_view = 0;      ///< of the first pulse's, whose chief ray meets the sensor
  std::size_t paired = 0;       ///< of those in view, lit at the second pulse too, by a tenth as much or more
  double largest_px = 0;        ///< displacement of the images of those in view, without medium [px]
};
ParticleCensus count_particles(Scene const& scene);

/// Warnings of particles that nothing can be measured by, in words.
std::vector<std::string> warnings_of_particles(Scene const& scene);

/// Checks of a PIV setup that go beyond single keys: what scatters nothing, a sheet beside the volume.
void cross_check_particles(Setup const& setup, SetupTable root, std::vector<std::string>& warnings);

}  // namespace gladstone
