#pragma once

#include <cstddef>

#include "render/light/mie_scattering.h"
#include "render/scene/lens_light.h"
#include "render/scene/renderer.h"

namespace gladstone::inline scene {

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

}  // namespace gladstone::inline scene
