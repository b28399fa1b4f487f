#pragma once

#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/light/mie_scattering.h"
#include "render/scene/lens_light.h"
#include "render/scene/renderer.h"

namespace gladstone::inline scene {

/// Largest change of a particle's final position when the integration step is halved [px].
inline constexpr double path_tolerance_px = 1e-5;

/// Returns the mean number of particles in the volume of a PIV setup.
/// For per_pixel, the fraction of the volume that the camera sees is estimated from the chief rays of 16384 points, to
/// about 0.1 %.
/// @pre setup.piv, and the particles are not read from a file
double particle_count(Setup const& setup);

/// Returns the memory that a setup's particles need, with the key of [particles] that sets their number.
MemoryRequirement particle_memory(Setup const& setup);

/// Adds particles, their scattering properties and the unit of light to a scene whose camera has been built.
/// @throws DataError if no particle is illuminated
void add_particles(Scene& scene);

/// Light that a particle sends through the lens, approximated by its intensity in the direction of the lens' centre.
class LightThroughLens {
 public:
  /// @param scene  must outlive this object
  /// @param light  scattering of the laser light, or an equal intensity in all directions
  explicit LightThroughLens(Scene const& scene, ParticleLight light = ParticleLight::scattered);

  /// Returns the photons through the lens from a position [m] per incident photon fluence at the particle [m^2].
  double operator()(Vec3d place, std::size_t particle, int pulse) const;

 private:
  double cross_section(Vec3d place, Vec3d direction, std::size_t particle, int pulse) const;

  Scene const& scene_;
  ParticleLight light_;
  LaserSheet<double> sheet_;
  LensLight lens_;
  MieScatteringView<double> mie_;
};

/// Returns the number of photons that a particle sends through the lens at a pulse.
double photons_through_lens(Scene const& scene, std::size_t particle, int pulse);

/// Returns the largest number of photons that any of the particles sends through the lens; 0 if none is illuminated.
double brightest_photons(Scene const& scene, Particles const& particles, ParticleLight light);

/// Returns the number of photons per unit of light in images of the particles.
/// For scattered laser light this is scene.photon_unit. Light that is equal in all directions is stronger by the ratio
/// of a square metre to the scattering cross-section, 1e12 or more, and would exceed the range of the fixed-point
/// images; the unit is therefore the light of the brightest particle.
double photon_unit(Scene const& scene, Particles const& particles, ParticleLight light);

/// Returns the number of electrons per unit of light: photons per unit of light times quantum efficiency. This limits
/// the exposure if the sensor has noise. Returns infinity without noise, where the full well only scales the grey
/// levels, and for BOS, whose light is not counted in photons.
double photon_limited_exposure(Scene const& scene);

/// Returns the exposure: the camera's own, or the one chosen from the brightest pixel, but at most the electrons
/// released by the particles' photons (photon_limited_exposure()) [e].
double choose_exposure(Scene const& scene, RenderedLight const& light);

/// Smallest displacement that correlation resolves at best; smaller displacements cause a warning [px].
inline constexpr double measurable_displacement_px = 0.01;

/// Particle counts from which the warnings of a PIV case are derived.
struct ParticleCensus {
  std::size_t lit[2] = {0, 0};  ///< number of illuminated particles at each pulse
  std::size_t in_view = 0;      ///< number of particles lit at the first pulse whose chief ray meets the sensor
  /// number of particles in view that receive at least a tenth of this light at the second pulse
  std::size_t paired = 0;
  double largest_px = 0;  ///< largest image displacement of the particles in view, without medium [px]
};
ParticleCensus count_particles(Scene const& scene);

/// Returns warnings for particles or flows that prevent a measurement.
Warnings warnings_of_particles(Scene const& scene);

/// Checks a PIV setup across keys: particles that scatter no light, a laser sheet outside the volume, optical elements,
/// wavelengths.
void cross_check_particles(Setup const& setup, SetupTable root, Warnings& warnings);

}  // namespace gladstone::inline scene
