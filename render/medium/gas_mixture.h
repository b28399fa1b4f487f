#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace gladstone::inline setup {
class SetupTable;
}

namespace gladstone::inline medium {

/// A gas whose Gladstone-Dale constant is known as a function of the wavelength.
struct Gas {
  std::string_view name;                        ///< key of the setup
  double molar_mass;                            ///< molar mass [kg/mol]
  double (*gladstone_dale)(double wavelength);  ///< returns the Gladstone-Dale constant K [m^3/kg] at a vacuum
                                                ///< wavelength [m]
};

/// Range of vacuum wavelengths in which the constants of all gases are valid [m]. Some of the dispersion formulas were
/// measured from 468 or 480 nm on; their resonances are below 130 nm, so that they are smooth down to 400 nm.
inline constexpr double shortest_gas_wavelength = 400e-9, longest_gas_wavelength = 800e-9;

/// Returns all gases: air, argon, carbon_dioxide, helium, hydrogen, methane, nitrogen, oxygen, water.
/// K = (n - 1) / rho, from the refractivity n - 1 and the density rho of the same state: 0 C and 101325 Pa, where rho =
/// p M / (R T (1 + B p / (R T))) with the second virial coefficient B of Dymond, Marsh, Wilhoit & Wong (Virial
/// Coefficients of Pure Gases, 2002). Refractivities:
/// - helium: Mansfield & Peck, J. Opt. Soc. Am. 59 (1969) 199
/// - nitrogen: Peck & Khanna, J. Opt. Soc. Am. 56 (1966) 1059
/// - argon: Peck & Fisher, J. Opt. Soc. Am. 54 (1964) 1362
/// - hydrogen: Peck & Hung, J. Opt. Soc. Am. 67 (1977) 1550
/// - carbon dioxide: Bideau-Mehu, Guern, Abjean & Johannin-Gilles, Opt. Commun. 9 (1973) 432
/// - methane: Loria, Ann. Phys. 334, 605 (1909)
/// - oxygen: Zhang, Lu & Wang, Appl. Opt. 47, 3143 (2008), at 20 C
/// - air (gladstone_dale_ciddor()) and water vapour (20 C, 1333 Pa, 9.85938e-3 kg/m^3): Ciddor, Appl. Opt. 35 (1996)
///   1566
std::span<Gas const> gases();

/// Fraction of a gas in a mixture.
struct GasFraction {
  Gas const* gas = nullptr;
  double mass_fraction = 0;  ///< [1]
};

/// Ideal mixture of gases. The refractivity of a mixture is the sum of those of its parts, n - 1 = sum of K_i rho_i
/// (Merzkirch, Flow Visualization, 2nd ed., 1987), so that K = sum of Y_i K_i with the mass fractions Y_i.
struct GasMixture {
  std::vector<GasFraction> parts;

  /// Returns K at a vacuum wavelength [m^3/kg]. @param wavelength  [m]
  double gladstone_dale(double wavelength) const;
  /// Returns M = 1 / (sum of Y_i / M_i) [kg/mol].
  double molar_mass() const;
};

/// Converts mole fractions X_i, given in the order of gases(), to mass fractions X_i M_i / (sum of X_j M_j).
GasMixture mixture_by_moles(std::span<double const> mole_fractions);
/// @param mass_fractions  in the order of gases()
GasMixture mixture_by_mass(std::span<double const> mass_fractions);

/// Reads the table [medium.gas]: a fraction of each gas, which add up to one, and whether they are of the moles (or
/// volume) or of the mass.
/// @param medium  the table [medium], at which problems of the whole mixture are reported
/// @param wavelength  [m]
GasMixture read_gas_mixture(SetupTable& medium, double wavelength);

}  // namespace gladstone::inline medium
