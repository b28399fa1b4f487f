#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>

#include "render/base/setup_table.h"
#include "render/base/vec.h"

namespace gladstone {

/// What says how many particles there are.
enum class ParticleCount { number, per_mm3, per_pixel, file };
/// How diameters are spread over particles.
enum class DiameterSpread { one, lognormal, normal, table };
/// What particles make of the laser's light.
enum class ParticleScattering {
  mie,
  lambert,   ///< matt white spheres
  gaussian,  ///< what falls on the particle's disc, alike into all directions: for ideal images, without rays
};

/// Diameters of particles, in SI.
struct DiameterSetup {
  DiameterSpread spread = DiameterSpread::one;
  double middle = 1e-6;  ///< the one, the median or the mean [m]
  double width = 0;      ///< standard deviation: of the logarithm [1], or of the diameter [m]
  std::string file;      ///< of a table
};

/// Table [particles] of a setup, in SI.
struct ParticleSetup {
  ParticleCount count = ParticleCount::number;
  double amount = 20000;        ///< in the volume; [1/mm^3]; or [1/px] in view of the first camera
  std::string file;             ///< CSV x_mm,y_mm,z_mm,diameter_um
  std::optional<Vec3d> volume;  ///< that the particles are in, about the centre [m]; empty: no limits (of a file)
  Vec3d center{};               ///< [m]
  DiameterSetup diameter;
  ParticleScattering scattering = ParticleScattering::mie;
  std::complex<double> index{1.45, 0};
  std::optional<double> density;  ///< of the particles [kg/m^3]; empty: they follow the flow
  double viscosity = 1.8e-5;      ///< dynamic, of the gas [Pa s]
  std::uint64_t seed = 1;

  /// Response time of a particle, rho_p d^2 / (18 mu) (Stokes) [s]; 0: follows the flow.
  double response_time(double diameter_m) const {
    return density ? *density * diameter_m * diameter_m / (18 * viscosity) : 0;
  }
};

/// Reads [particles]. @param wavelength of the laser in vacuum, for the index of named materials [m]
ParticleSetup read_particle_setup(SetupTable table, double wavelength);

}  // namespace gladstone
