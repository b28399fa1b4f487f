#pragma once

#include <cmath>

namespace gladstone::inline cases {

/// Range of parameters in which the random error was measured.
struct RandomErrorRange {
  double least_dot;                    ///< geometric diameter of a dot's image [px]
  double most_image;                   ///< e^-2 diameter of the whole image, d in random_error_px() [px]
  double narrowest_spot, widest_spot;  ///< standard deviation of the Gaussian PSF [px]
  double least_noise, most_noise;      ///< standard deviation relative to the peak [1]
  double fewest_dots, most_dots;       ///< dots per window
};
inline constexpr RandomErrorRange random_error_range{0.8, 5.1, 0.1, 0.8, 0.006, 0.111, 5, 45};

/// Returns the part of random_error_px() that depends on the dots' sub-pixel positions, pattern (20 / N_I)^0.24 [px].
template <class T>
T pattern_error_px(T geometric_px, T spot_px, double dots) {
  using std::exp;
  using std::sqrt;
  T const g2 = geometric_px * geometric_px, s2 = spot_px * spot_px;
  constexpr double widest = random_error_range.widest_spot * random_error_range.widest_spot;
  T const smooth = s2 < widest ? s2 : T(widest);
  T const even = 0.006 * exp(-7.4 * smooth), small = 0.204 * exp(-1.76 * g2 - 9.7 * smooth);
  constexpr double least = 0.00135;  // [px]
  return sqrt(even * even + small * small + least * least) * std::pow(20 / dots, 0.24);
}

/// Returns the random error of a displacement measured by our correlator with default settings, along the displacement,
/// averaged over all sub-pixel fractions [px]. (Perpendicular to the displacement, the error is 0.3 to 1.1 times as
/// large; see docs/design.md.) It combines the error due to the dots' sub-pixel positions, which decreases with the
/// size of dots and PSF, and that due to noise, which decreases with number and size of the dots and increases with the
/// PSF.
///
///   pattern^2 = (0.006 exp(-7.4 s^2))^2 + (0.204 exp(-1.76 g^2 - 9.7 s^2))^2 + 0.00135^2
///   noise = 0.287 q (1 + 1.6 s^2) d^-0.737,   d^2 = g^2 + 16 s^2
///   sigma^2 = pattern^2 (20 / N_I)^0.48 + noise^2 (20 / N_I)
///
/// Fitted to the 144 cases of the study random_error (data/estimators/random_error.csv: dots of 0.8 to 4 px, PSF of
/// sigma 0.1 to 0.8 px, noise of 0.6 to 11 % of the peak, 5 to 45 dots per window, strain of 0.005). The rms deviation
/// from them is 18 %, the largest a factor of 1.7. Strains up to 0.02 have no effect (docs/estimators.md). In the
/// pattern term, wider PSFs are treated like the widest one measured.
/// @param geometric_px  g, diameter of the dot's geometric image [px]
/// @param spot_px       s, standard deviation of the Gaussian PSF [px]
/// @param noise         q, standard deviation of the noise at the peak, relative to the peak [1]
/// @param dots          N_I, number of dots in the last pass's window
template <class T>
T random_error_px(T geometric_px, T spot_px, T noise, double dots) {
  using std::pow;
  using std::sqrt;
  T const pattern = pattern_error_px(geometric_px, spot_px, dots), s2 = spot_px * spot_px;
  T const part = 0.287 * noise * (1.0 + 1.6 * s2) * pow(geometric_px * geometric_px + 16.0 * s2, -0.3685);
  return sqrt(pattern * pattern + part * part * (20 / dots));
}

}  // namespace gladstone::inline cases
