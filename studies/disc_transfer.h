#pragma once

#include <cmath>  // and j1, which is of POSIX

#include "render/base/units.h"

namespace gladstone {

/// Bessel function of the first kind of order one. Named as Ceres names it, so that one template takes numbers and
/// Jets.
inline double BesselJ1(double x) { return ::j1(x); }

/// Mean of a wave over a disc, 2 J1(x) / x with x = pi times diameter over wavelength.
template <class T>
T disc_transfer(T diameter, T wavelength) {
  T const x = pi * diameter / wavelength;
  if (x < 1e-4) return 1.0 - x * x / 8.0;  // the rest is x^4 / 192
  return 2.0 * BesselJ1(x) / x;
}

/// What the cone of light from a point in focus leaves of a wave of density: disc_transfer of the cone at every slice
/// of the field, whose lever is its distance s from the dots, over the thickness (F10). For displacements much smaller
/// than the wave.
/// @param pupil diameter of the entrance pupil; z_b lens to dots; z_d mid-plane to dots; thickness of the field;
///              wavelength of the density [m]
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

}  // namespace gladstone
