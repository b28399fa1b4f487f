#pragma once

#include <string>
#include <vector>

namespace gladstone {

/// Fraunhofer's lines that nd and Vd are defined by, in air [m].
namespace spectral_line {
inline constexpr double d = 587.5618e-9;  ///< helium
inline constexpr double F = 486.1327e-9;  ///< hydrogen
inline constexpr double C = 656.2725e-9;  ///< hydrogen
}  // namespace spectral_line

/// How a glass's index depends on wavelength; the numbers are those of the AGF format, which describes them all.
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

/// A glass of a catalogue, or one that a prescription describes itself. Indices are catalogue values: against air of
/// the conditions of measurement, which counts as 1.
struct Glass {
  std::string name;
  std::string catalogue;  ///< name of its file without folder and ending
  DispersionFormula formula = DispersionFormula::schott;
  std::vector<double> coefficients;  ///< as the formula takes them, wavelengths in micrometres
  double shortest = 0;               ///< wavelengths that the formula was fitted to [m]
  double longest = 0;
  struct Transmission {
    double wavelength;    ///< [m]
    double transmission;  ///< internal [1]
    double thickness;     ///< that it was measured through [m]
  };
  std::vector<Transmission> transmission;  ///< rising wavelengths; may be empty
  struct Sample {
    double wavelength;  ///< [m]
    double index;       ///< [1]
  };
  std::vector<Sample> samples;  ///< of a glass that has no formula; rising wavelengths
  double printed_nd = 0;        ///< that the catalogue prints beside the formula; 0: none [1]

  /// Index at a wavelength [m]: by the formula, or a polynomial in 1/lambda^2 (Cauchy) through the four nearest
  /// samples.
  /// @pre the wavelength is within [shortest, longest]
  double index(double wavelength) const;
  /// Loss of light per length inside the glass, linear between the catalogue's wavelengths; 0 where it has none [1/m].
  double absorption(double wavelength) const;
  double nd() const { return index(spectral_line::d); }
  /// Abbe number (nd - 1) / (nF - nC).
  double vd() const;

  /// The glass n = A + B / lambda^2 of given nd and Vd (Cauchy's formula): good to 1e-3 in the visible, no better.
  static Glass from_nd_vd(double nd, double vd);
  /// One index at every wavelength.
  static Glass constant(double index);
  /// A glass of indices at wavelengths in any order. @pre there is one or more, of different wavelengths
  static Glass from_samples(std::string name, std::vector<Sample> samples);
};

}  // namespace gladstone
