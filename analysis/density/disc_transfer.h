#pragma once

#include <cmath>  // also declares j1 (POSIX)

#include "render/base/units.h"

namespace gladstone::inline density {

/// Bessel function of the first kind of order one. Has the name of the Ceres function, so that templates accept both
/// numbers and Jets.
inline double BesselJ1(double x) { return ::j1(x); }

/// Returns the mean of a plane wave over a disc, relative to the wave's value at the disc's centre: 2 J1(x) / x with x
/// = pi diameter / wavelength.
template <class T>
T disc_transfer(T diameter, T wavelength) {
  T const x = pi * diameter / wavelength;
  if (x < 1e-4) return 1.0 - x * x / 8.0;  // the first omitted term of the series is x^4 / 192
  return 2.0 * BesselJ1(x) / x;
}

/// Returns the factor by which averaging over the light cone of a point in focus changes the amplitude of a density
/// wave: disc_transfer() of the cone's diameter at every slice of the field, averaged over the thickness with the
/// slice's distance s from the dots as weight (F10 in docs/design.md). Valid for displacements much smaller than the
/// wavelength.
/// @param pupil       diameter of the entrance pupil [m]
/// @param z_b         distance from lens to dots [m]
/// @param z_d         distance from the medium's mid-plane to the dots [m]
/// @param thickness   thickness of the medium [m]
/// @param wavelength  wavelength of the density [m]
template <class T>
T cone_transfer(T pupil, T z_b, T z_d, double thickness, T wavelength) {
  constexpr int slices = 16;
  T sum(0);
  for (int i = 0; i < slices; ++i) {
    T const s = z_d + thickness * ((i + 0.5) / slices - 0.5);
    sum += s * disc_transfer(T(pupil * s / z_b), wavelength);
  }
  return sum / (double{slices} * z_d);
}

}  // namespace gladstone::inline density
