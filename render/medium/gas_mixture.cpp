#include "render/medium/gas_mixture.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/text.h"
#include "render/base/units.h"
#include "render/medium/gladstone_dale.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {
namespace {

/// Molar volume of an ideal gas at 0 C and 101325 Pa, R T / p [m^3/mol] (CODATA 2018).
constexpr double molar_volume = 8.314462618 * 273.15 / 101325;

/// Returns sigma^2, sigma being the vacuum wavenumber [1/um^2].
constexpr double squared_wavenumber(double wavelength) {
  double const sigma = 1e-6 / wavelength;
  return sigma * sigma;
}

/// Returns K from the refractivity at 0 C and 101325 Pa.
/// @param virial  second virial coefficient at 0 C [m^3/mol]
constexpr double constant_of(double refractivity, double molar_mass, double virial) {
  return refractivity * molar_volume * (1 + virial / molar_volume) / molar_mass;
}

constexpr double helium_mass = 4.002602e-3, hydrogen_mass = 2.01588e-3, nitrogen_mass = 28.0134e-3,
                 oxygen_mass = 31.9988e-3, argon_mass = 39.948e-3, carbon_dioxide_mass = 44.0095e-3,
                 methane_mass = 16.0425e-3, water_mass = 18.01528e-3, air_mass = 28.9641e-3;

double argon(double wavelength) {
  double const s2 = squared_wavenumber(wavelength);
  return constant_of(6.7867e-5 + 3.0182943e-2 / (144 - s2), argon_mass, -21.5e-6);
}

double carbon_dioxide(double wavelength) {
  double const s2 = squared_wavenumber(wavelength);
  double const refractivity = 6.99100e-2 / (166.175 - s2) + 1.44720e-3 / (79.609 - s2) + 6.42941e-5 / (56.3064 - s2) +
                              5.21306e-5 / (46.0196 - s2) + 1.46847e-6 / (0.0584738 - s2);
  return constant_of(refractivity, carbon_dioxide_mass, -150e-6);
}

double helium(double wavelength) {
  return constant_of(0.01470091 / (423.98 - squared_wavenumber(wavelength)), helium_mass, 12e-6);
}

double hydrogen(double wavelength) {
  double const s2 = squared_wavenumber(wavelength);
  return constant_of(0.0148956 / (180.7 - s2) + 0.0049037 / (92 - s2), hydrogen_mass, 13.7e-6);
}

double nitrogen(double wavelength) {
  return constant_of(6.8552e-5 + 3.243157e-2 / (144 - squared_wavenumber(wavelength)), nitrogen_mass, -10.5e-6);
}

/// Returns A (1 + B sigma^2), Cauchy's formula. @param b  [um^2]
double cauchy(double a, double b, double wavelength) { return a * (1 + b * squared_wavenumber(wavelength)); }

double methane(double wavelength) { return constant_of(cauchy(42.6e-5, 14.41e-3, wavelength), methane_mass, -53.4e-6); }

double oxygen(double wavelength) {
  // Zhang's refractivity holds at 20 C, where the density is lower.
  double const at_20_degrees = 1.181494e-4 + 9.708931e-3 / (75.4 - squared_wavenumber(wavelength));
  return constant_of(at_20_degrees * (293.15 / 273.15), oxygen_mass, -17e-6);
}

double water(double wavelength) {
  double const s2 = squared_wavenumber(wavelength);
  double const refractivity = 1.022e-8 * (295.235 + 2.6422 * s2 - 0.032380 * s2 * s2 + 0.004028 * s2 * s2 * s2);
  return refractivity / 9.85938e-3;
}

constexpr std::array all_gases{Gas{"air", air_mass, &gladstone_dale_ciddor},
                               Gas{"argon", argon_mass, &argon},
                               Gas{"carbon_dioxide", carbon_dioxide_mass, &carbon_dioxide},
                               Gas{"helium", helium_mass, &helium},
                               Gas{"hydrogen", hydrogen_mass, &hydrogen},
                               Gas{"methane", methane_mass, &methane},
                               Gas{"nitrogen", nitrogen_mass, &nitrogen},
                               Gas{"oxygen", oxygen_mass, &oxygen},
                               Gas{"water", water_mass, &water}};

/// Chemical formulas of the gases, in the order of all_gases; empty: a mixture.
constexpr std::array<char const*, all_gases.size()> formulas{"", "Ar", "CO2", "He", "H2", "CH4", "N2", "O2", "H2O"};

/// Reports gases that are named by their formula, in upper or lower case.
/// @return true if there is one
bool refuse_formulas(SetupTable& table) {
  bool any = false;
  for (std::size_t i = 0; i < formulas.size(); ++i) {
    for (std::string const& key : {std::string(formulas[i]), lower_case(formulas[i])}) {
      if (key.empty() || !table.has(key)) continue;
      table.number(key, 0.0);  // otherwise it is reported as an unknown key, too
      table.problem(key,
                    fmt::format("unknown key \"{0}\" in [medium.gas]; did you mean \"{1}\"?", key, all_gases[i].name),
                    ErrorCode::unknown_key);
      any = true;
    }
  }
  return any;
}

}  // namespace

std::span<Gas const> gases() { return all_gases; }

double GasMixture::gladstone_dale(double wavelength) const {
  double sum = 0;
  for (GasFraction const& part : parts) sum += part.mass_fraction * part.gas->gladstone_dale(wavelength);
  return sum;
}

double GasMixture::molar_mass() const {
  double moles = 0;
  for (GasFraction const& part : parts) moles += part.mass_fraction / part.gas->molar_mass;
  return 1 / moles;
}

GasMixture mixture_by_mass(std::span<double const> mass_fractions) {
  GLADSTONE_EXPECTS(mass_fractions.size() == all_gases.size());
  GasMixture mixture;
  for (std::size_t i = 0; i < all_gases.size(); ++i) {
    if (mass_fractions[i] > 0) mixture.parts.push_back({&all_gases[i], mass_fractions[i]});
  }
  return mixture;
}

GasMixture mixture_by_moles(std::span<double const> mole_fractions) {
  GLADSTONE_EXPECTS(mole_fractions.size() == all_gases.size());
  std::array<double, all_gases.size()> mass{};
  double sum = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    mass[i] = mole_fractions[i] * all_gases[i].molar_mass;
    sum += mass[i];
  }
  for (double& one : mass) one /= sum;
  return mixture_by_mass(mass);
}

GasMixture read_gas_mixture(SetupTable& medium, double wavelength) {
  constexpr double tolerance = 1e-6;  // rounding of fractions that add up to one
  SetupTable table = medium.table("gas");
  bool const by_mass = table.word("fractions", "mole", {"mole", "mass"}) == "mass";
  std::array<double, all_gases.size()> fractions{};
  // NaN if a fraction is wrong, which is reported already
  double sum = refuse_formulas(table) ? not_a_number : 0.0;
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    std::string const name(gases()[i].name);
    fractions[i] = table.number(name, table.has(name) ? not_a_number : 0.0, Range::at_least(0.0, 1.0));
    sum += fractions[i];
  }
  if (std::abs(sum - 1) > tolerance) {
    medium.problem("gas",
                   fmt::format("has fractions that add up to {:.7g} (they must add up to 1); correct them", sum));
  }
  if (!(std::abs(sum - 1) <= tolerance)) {
    fractions = {};
    fractions.front() = 1;  // assume air, so that reading continues
  }
  if (wavelength < shortest_gas_wavelength || wavelength > longest_gas_wavelength) {
    medium.problem("gas", fmt::format("has no constant at {:.6g} nm (the formulas are valid from {:.0f} to {:.0f} nm); "
                                      "remove it and give gladstone_dale as a number",
                                      wavelength / unit::nanometre, shortest_gas_wavelength / unit::nanometre,
                                      longest_gas_wavelength / unit::nanometre));
  }
  return by_mass ? mixture_by_mass(fractions) : mixture_by_moles(fractions);
}

}  // namespace gladstone::inline medium
