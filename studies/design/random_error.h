#pragma once

#include <cmath>

namespace gladstone {

/// What the random error was measured at.
struct RandomErrorRange {
  double least_dot;                    ///< geometric diameter of a dot's image [px]
  double most_image;                   ///< e^-2 diameter of the whole image, d below [px]
  double narrowest_spot, widest_spot;  ///< standard deviation [px]
  double least_noise, most_noise;      ///< over the peak [1]
  double fewest_dots, most_dots;       ///< in a window
};
inline constexpr RandomErrorRange random_error_range{0.8, 5.1, 0.1, 0.8, 0.006, 0.111, 5, 45};

/// The part of random_error_px() that the places of the dots on the pixels cause, pattern (20 / N_I)^0.24 [px].
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

/// Random error of a displacement that our correlator measures with its default settings, along it, where it goes
/// through all fractions of a pixel [px] (across it, where nothing moves, 0.3 to 1.1 of that: docs/design.md): what the
/// places of the dots on the pixels change, which falls as dots grow and as their spots smooth them, and what noise
/// changes, which falls with the number and the size of the dots and grows with the width of their spots.
///
///   pattern^2 = (0.006 exp(-7.4 s^2))^2 + (0.204 exp(-1.76 g^2 - 9.7 s^2))^2 + 0.00135^2
///   noise = 0.287 q (1 + 1.6 s^2) d^-0.737,   d^2 = g^2 + 16 s^2
///   sigma^2 = pattern^2 (20 / N_I)^0.48 + noise^2 (20 / N_I)
///
/// Fitted to the 144 cases of the study random_error (data/estimators/random_error.csv: dots of 0.8 to 4 px under spots
/// of sigma 0.1 to 0.8 px, noise of 0.6 to 11 % of the peak, 5 to 45 dots in a window, strain of 0.005): 18 % from
/// them in the root mean square, never by more than a factor of 1.7. Strains up to 0.02 change nothing
/// (docs/estimators.md).
/// Wider spots than measured count as the widest in the pattern.
/// @param geometric_px  g, diameter of the dot's geometric image [px]
/// @param spot_px       s, standard deviation of the Gaussian spot [px]
/// @param noise         q, standard deviation at the peak over the peak [1]
/// @param dots          N_I in the last pass's window
template <class T>
T random_error_px(T geometric_px, T spot_px, T noise, double dots) {
  using std::pow;
  using std::sqrt;
  T const pattern = pattern_error_px(geometric_px, spot_px, dots), s2 = spot_px * spot_px;
  T const part = 0.287 * noise * (1.0 + 1.6 * s2) * pow(geometric_px * geometric_px + 16.0 * s2, -0.3685);
  return sqrt(pattern * pattern + part * part * (20 / dots));
}

}  // namespace gladstone
