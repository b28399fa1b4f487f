#pragma once

#include "render/base/units.h"

namespace gladstone {

/// Light that a camera gets from white paper: radiance and time.
struct PaperLight {
  double radiance = 0;       ///< of white paper under the lamp [W / (m^2 sr)]
  double exposure_time = 0;  ///< [s]
};

/// Electrons in a pixel on the axis that sees nothing but white paper, by the camera equation (F21): exposure
/// pi L t / (4 N^2 (1 + M)^2) [J/m^2] times the pixel's area, over the energy of a photon, times the quantum
/// efficiency. A pixel is all sensitive, and the lens passes all light.
/// @param light         radiance L and time t
/// @param f_number      N of the lens at infinity [1]
/// @param magnification M [1]
/// @param pitch         of the pixels [m]; wavelength [m]; efficiency electrons a photon
template <class T>
T fully_lit_electrons(PaperLight const& light, T f_number, T magnification, double pitch, double wavelength,
                      double efficiency) {
  T const working = f_number * (1.0 + magnification);
  double const photon = constant::planck * constant::speed_of_light / wavelength;
  return pi * light.radiance * light.exposure_time * pitch * pitch * efficiency / (4.0 * photon) / (working * working);
}

}  // namespace gladstone
