#pragma once

#include <complex>
#include <string>
#include <vector>

#include "render/base/setup_table.h"

namespace gladstone {

/// A substance that flows are seeded with.
struct ParticleMaterial {
  std::string name;    ///< as the setup has it
  std::string source;  ///< of its index: author, year
  double shortest;     ///< wavelengths that the source covers [m]
  double longest;
  /// Of the substance at a wavelength in vacuum [m], n + i k; crystals: the mean over all orientations.
  std::complex<double> (*index)(double wavelength);
};

/// All of them: dehs (also named oil), water, tio2 (rutile), al2o3 (corundum), glass (soda-lime).
std::vector<ParticleMaterial> const& particle_materials();

/// Names that a setup may use.
std::vector<std::string> particle_material_names();

/// The material of that name. @pre the name is one of particle_material_names()
ParticleMaterial const& particle_material(std::string const& name);

/// Key `material` of [particles], or else `index = [n, k]`, for n + i k; neither: an oil's, 1.45.
/// @param wavelength of the laser in vacuum [m]
std::complex<double> read_particle_index(SetupTable table, double wavelength);

}  // namespace gladstone
