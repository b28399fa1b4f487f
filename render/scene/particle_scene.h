#pragma once

#include <string>
#include <vector>

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

}  // namespace gladstone::inline scene
