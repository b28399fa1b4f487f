#pragma once

#include <complex>
#include <string>
#include <vector>

#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Material of seeding particles.
struct ParticleMaterial {
  std::string name;    ///< name in a setup
  std::string source;  ///< source of the refractive index: author, year
  double shortest;     ///< shortest vacuum wavelength covered by the source [m]
  double longest;      ///< longest vacuum wavelength covered by the source [m]
  /// Complex refractive index n + i k at a vacuum wavelength [m]. Crystals: mean over all orientations.
  std::complex<double> (*index)(double wavelength);
};

/// Returns all materials: dehs (also named oil), water, tio2 (rutile), al2o3 (corundum), glass (soda-lime).
std::vector<ParticleMaterial> const& particle_materials();

/// Returns the material names accepted in a setup.
std::vector<std::string> particle_material_names();

/// Returns the material of a given name. @pre name is one of particle_material_names()
ParticleMaterial const& particle_material(std::string const& name);

/// Reads the refractive index n + i k of the particles from the key `material` or `index = [n, k]`; without either,
/// 1.45 (oil).
/// @param wavelength  vacuum wavelength of the laser [m]
std::complex<double> read_particle_index(SetupTable table, double wavelength);

}  // namespace gladstone::inline light
