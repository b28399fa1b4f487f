#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <string>

#include "render/base/host_device.h"
#include "render/base/vec.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Key that specifies the number of particles.
enum class ParticleCount { number, per_mm3, per_pixel, file };
/// Distribution of the particle diameters.
enum class DiameterSpread { one, lognormal, normal, table };
/// Model of the light scattered by particles.
enum class ParticleScattering {
  mie,
  lambert,   ///< white diffuse spheres
  gaussian,  ///< isotropic scattering of the light incident on the particle's cross-section, for ideal images without
             ///< rays
};

/// Distribution of particle diameters, in SI.
struct DiameterSetup {
  DiameterSpread spread = DiameterSpread::one;
  double middle = 1e-6;  ///< single diameter, median (lognormal) or mean (normal) [m]
  double width = 0;      ///< standard deviation of ln(diameter) [1] (lognormal) or of the diameter [m] (normal)
  std::string file;      ///< CSV file with the columns diameter_um,weight, for DiameterSpread::table
};

/// Returns the Stokes response time of a sphere in a gas, rho_p d^2 / (18 mu) [s].
GLADSTONE_HD constexpr double stokes_response_time(double density, double diameter_m, double viscosity) {
  return density * diameter_m * diameter_m / (18 * viscosity);
}

/// Table [particles] of a setup, in SI.
struct ParticleSetup {
  ParticleCount count = ParticleCount::number;
  double amount = 20000;        ///< number; number density [1/mm^3]; number per pixel of the first camera [1/px]
  std::string file;             ///< CSV file with the columns x_mm,y_mm,z_mm,diameter_um, for ParticleCount::file
  std::optional<Vec3d> volume;  ///< size of the seeded box about `center` [m]; empty: unlimited (file only)
  Vec3d center{};               ///< centre of the seeded box [m]
  DiameterSetup diameter;
  ParticleScattering scattering = ParticleScattering::mie;
  std::complex<double> index{1.45, 0};
  std::optional<double> density;  ///< density of the particles [kg/m^3]; empty: tracers without lag
  double viscosity = 1.8e-5;      ///< dynamic viscosity of the gas [Pa s]
  std::uint64_t seed = 1;

  /// Returns the Stokes response time of a particle [s]; 0: no lag.
  double response_time(double diameter_m) const {
    return density ? stokes_response_time(*density, diameter_m, viscosity) : 0;
  }
};

/// Reads table [particles]. @param wavelength  vacuum wavelength of the laser, for the index of named materials [m]
ParticleSetup read_particle_setup(SetupTable table, double wavelength);

}  // namespace gladstone::inline light
