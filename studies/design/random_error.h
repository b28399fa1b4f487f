#pragma once

#include <cmath>

namespace gladstone {

/// Diameters of dot images [px] and noise over peak that the random error was measured at.
struct RandomErrorRange {
  double least_diameter, most_diameter, least_noise, most_noise;
  bool holds(double diameter_px, double noise) const {
    return diameter_px >= least_diameter && diameter_px <= most_diameter && noise <= most_noise;
  }
};
inline constexpr RandomErrorRange random_error_range{1.0, 4.5, 0.005, 0.12};

/// Random error of a displacement that our correlator measures, per component [px].
template <class T>
T random_error_px(T diameter_px, T noise, double dots_in_window) {
  using std::exp;
  using std::pow;
  using std::sqrt;
  T const pattern = 0.0014 + 0.21 * exp(-2.1 * diameter_px), part = 0.4 * noise * pow(diameter_px, 0.6);
  return sqrt((pattern * pattern + part * part) * (20 / dots_in_window));
}

}  // namespace gladstone
