#include "render/light/particle_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/units.h"

namespace gladstone::inline light {
namespace {

constexpr double least_index = 0.01;  // lower limit of the index's real part; metals have 0.05 or more

/// Sellmeier equation: returns sqrt(1 + sum of B L^2 / (L^2 - C)), wavelength L in um and C in um^2.
/// @param wavelength  [m]
template <std::size_t N>
double sellmeier(double wavelength, double const (&b)[N], double const (&c)[N]) {
  double const l2 = wavelength * wavelength * 1e12;
  double n2 = 1;
  for (std::size_t i = 0; i < N; ++i) n2 += b[i] * l2 / (l2 - c[i]);
  return std::sqrt(n2);
}

/// Returns the mean refractive index of a uniaxial crystal over all orientations.
double over_orientations(double ordinary, double extraordinary) { return (2 * ordinary + extraordinary) / 3; }

std::complex<double> index_of_dehs(double) { return 1.450; }

std::complex<double> index_of_water(double wavelength) {
  return sellmeier<4>(wavelength, {5.684027565e-1, 1.726177391e-1, 2.086189578e-2, 1.130748688e-1},
                      {5.101829712e-3, 1.821153936e-2, 2.620722293e-2, 1.069792721e1});
}

std::complex<double> index_of_rutile(double wavelength) {
  double const l2 = wavelength * wavelength * 1e12;
  return over_orientations(std::sqrt(5.913 + 0.2441 / (l2 - 0.0803)), std::sqrt(7.197 + 0.3322 / (l2 - 0.0843)));
}

constexpr double squared(double x) { return x * x; }

std::complex<double> index_of_corundum(double wavelength) {
  return over_orientations(sellmeier<3>(wavelength, {1.4313493, 0.65054713, 5.3414021},
                                        {squared(0.0726631), squared(0.1193242), squared(18.028251)}),
                           sellmeier<3>(wavelength, {1.5039759, 0.55069141, 6.5927379},
                                        {squared(0.0740288), squared(0.1216529), squared(20.072248)}));
}

std::complex<double> index_of_soda_lime(double wavelength) {
  double const l2 = wavelength * wavelength * 1e12;
  return 1.5130 - 0.003169 * l2 + 0.003962 / l2;
}

}  // namespace

std::vector<ParticleMaterial> const& particle_materials() {
  constexpr double um = unit::micrometre;
  static std::vector<ParticleMaterial> const materials{
      {"dehs", "bis(2-ethylhexyl) sebacate, n_D = 1.450 as suppliers state it; one value at all wavelengths", 0.3 * um,
       1.1 * um, index_of_dehs},
      {"water", "distilled, 20 C: Daimon & Masumura, Appl. Opt. 46 (2007) 3811", 0.182 * um, 1.129 * um,
       index_of_water},
      {"tio2", "rutile, mean over orientations: DeVore, J. Opt. Soc. Am. 41 (1951) 416", 0.43 * um, 1.53 * um,
       index_of_rutile},
      {"al2o3", "corundum, mean over orientations: Malitson & Dodge, J. Opt. Soc. Am. 62 (1972) 1405", 0.2 * um,
       5.0 * um, index_of_corundum},
      {"glass", "soda-lime, absorption below 2e-6 neglected: Rubin, Sol. Energy Mater. 12 (1985) 275", 0.35 * um,
       0.75 * um, index_of_soda_lime},
  };
  return materials;
}

std::vector<std::string> particle_material_names() {
  std::vector<std::string> names;
  for (ParticleMaterial const& material : particle_materials()) names.push_back(material.name);
  names.emplace_back("oil");
  return names;
}

ParticleMaterial const& particle_material(std::string const& name) {
  auto const& materials = particle_materials();
  auto const found = std::find_if(materials.begin(), materials.end(), [&](ParticleMaterial const& material) {
    return material.name == (name == "oil" ? "dehs" : name);
  });
  GLADSTONE_EXPECTS(found != materials.end());
  return *found;
}

std::complex<double> read_particle_index(SetupTable table, double wavelength) {
  if (!table.has("material")) {
    auto const parts = table.numbers("index", {1.45, 0.0}, 2, Range::at_least(0.0, 100.0));
    if (parts.size() != 2) return 1.45;
    if (parts[0] < least_index) {
      table.problem("index",
                    fmt::format("has a real part of {:g} (index = [n, k] is n + i k; {} <= n <= 100); give the "
                                "refractive index",
                                parts[0], least_index));
      return 1.45;
    }
    return {parts[0], parts[1]};
  }
  table.refuse("index", "conflicts with material, which determines the index; remove one of them");
  std::string const name = table.word("material", "dehs", particle_material_names());
  ParticleMaterial const& material = particle_material(name);
  if (wavelength < material.shortest || wavelength > material.longest) {
    table.problem("material",
                  "has no known index at the laser's wavelength (" + material.source + "); give index = [n, k]");
  }
  return material.index(wavelength);
}

}  // namespace gladstone::inline light
