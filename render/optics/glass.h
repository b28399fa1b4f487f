#pragma once

#include <string>
#include <vector>

namespace gladstone::inline optics {

/// Wavelengths, in air, of the Fraunhofer lines that define nd and Vd [m].
namespace spectral_line {
inline constexpr double d = 587.5618e-9;  ///< helium line
inline constexpr double F = 486.1327e-9;  ///< hydrogen line
inline constexpr double C = 656.2725e-9;  ///< hydrogen line
}  // namespace spectral_line

/// Dispersion formulas of the AGF format, by its numbers.
enum class DispersionFormula : int {
  schott = 1,
  sellmeier1 = 2,
  herzberger = 3,
  sellmeier2 = 4,
  conrady = 5,
  sellmeier3 = 6,
  handbook_of_optics1 = 7,
  handbook_of_optics2 = 8,
  sellmeier4 = 9,
  extended1 = 10,
  sellmeier5 = 11,
  extended2 = 12,
  extended3 = 13,
};
inline constexpr int dispersion_formulas = 13;

/// Optical glass from a catalogue or a prescription. Refractive indices are catalogue values, relative to air under the
/// conditions of the measurement.
struct Glass {
  std::string name;
  std::string catalogue;  ///< file name without folder and extension
  std::string where{};    ///< file:line of its entry in the catalogue; empty: defined by a prescription
  DispersionFormula formula = DispersionFormula::schott;
  std::vector<double> coefficients;  ///< coefficients in the order of the formula, for wavelengths in micrometres
  double shortest = 0;               ///< shortest wavelength of the formula's range of validity [m]
  double longest = 0;                ///< longest wavelength of the formula's range of validity [m]
  struct Transmission {
    double wavelength;    ///< [m]
    double transmission;  ///< internal transmittance [1]
    double thickness;     ///< thickness of glass with this transmittance [m]
  };
  std::vector<Transmission> transmission;  ///< samples of the transmission in order of wavelength; may be empty
  struct Sample {
    double wavelength;  ///< [m]
    double index;       ///< [1]
  };
  std::vector<Sample> samples;  ///< indices of a glass without a formula, in order of wavelength
  double printed_nd = 0;        ///< nd printed in the catalogue in addition to the formula; 0: none [1]

  /// Returns the index at a wavelength [m], by the formula or by a polynomial in 1/lambda^2 (Cauchy) through the four
  /// nearest samples. @pre the wavelength is within [shortest, longest]
  double index(double wavelength) const;
  /// Returns the absorption coefficient of the glass, interpolated linearly between the catalogue's wavelengths [1/m];
  /// 0 if the catalogue has no data.
  double absorption(double wavelength) const;
  double nd() const { return index(spectral_line::d); }

  /// Returns a glass with n = A + B / lambda^2 for given nd and Vd (Cauchy's formula). Accurate to 1e-3 in the visible
  /// range.
  static Glass from_nd_vd(double nd, double vd);
  /// Returns a glass with tabulated indices, in any order. @pre at least one sample; all wavelengths differ
  static Glass from_samples(std::string name, std::vector<Sample> samples);
};

}  // namespace gladstone::inline optics
