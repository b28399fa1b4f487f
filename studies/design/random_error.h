#pragma once

#include <cmath>

namespace gladstone {

/// What the random error was measured at: geometric diameters of dots, diameters of their images (e^-2, d below) and
/// standard deviations of their spots [px], noise over peak [1].
struct RandomErrorRange {
  double least_dot, most_image, widest_spot, most_noise;
  bool holds(double geometric_px, double image_px, double noise) const {
    return geometric_px >= least_dot && image_px <= most_image && noise <= most_noise;
  }
};
inline constexpr RandomErrorRange random_error_range{0.8, 4.2, 0.276, 0.111};

/// Random error of a displacement that our correlator measures with its default settings, per component [px]: what the
/// places of the dots on the pixels change, which falls as dots grow and as their spots smooth them, and what noise
/// changes, which falls with the number and the size of the dots.
///
///   pattern^2 = (0.0057 exp(-5.4 s^2))^2 + (0.21 exp(-1.76 g^2 - 10.5 s^2))^2,   noise = 0.272 q d^-0.59
///   sigma^2 = pattern^2 (20 / N_I)^0.61 + noise^2 (20 / N_I),                     d^2 = g^2 + 16 s^2
///
/// Fitted to the 72 cases of the study random_error (data/estimators/random_error.csv: dots of 0.8 to 4 px under spots
/// of sigma 0.1 and 0.28 px, noise of 0.6 to 11 % of the peak, 5 to 45 dots in a window, strain of 0.005): 20 % from
/// them in the root mean square, never by more than a factor of 1.7. Strains up to 0.02 change nothing
/// (docs/estimators.md).
/// Wider spots than measured count as the widest in the pattern.
/// @param geometric_px  g, diameter of the dot's geometric image [px]
/// @param spot_px       s, standard deviation of the Gaussian spot [px]
/// @param noise         q, standard deviation at the peak over the peak [1]
/// @param dots          N_I in the last pass's window
template <class T>
T random_error_px(T geometric_px, T spot_px, T noise, double dots) {
  using std::exp;
  using std::pow;
  using std::sqrt;
  T const g2 = geometric_px * geometric_px, s2 = spot_px * spot_px;
  constexpr double widest = random_error_range.widest_spot * random_error_range.widest_spot;
  T const smooth = s2 < widest ? s2 : T(widest);
  T const even = 0.0057 * exp(-5.4 * smooth), small = 0.21 * exp(-1.76 * g2 - 10.5 * smooth);
  T const part = 0.272 * noise * pow(g2 + 16.0 * s2, -0.295);
  return sqrt((even * even + small * small) * std::pow(20 / dots, 0.61) + part * part * (20 / dots));
}

}  // namespace gladstone
