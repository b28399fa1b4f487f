#pragma once

#include "render/base/units.h"

namespace gladstone::inline sensor {

/// Illumination of the target: radiance of white paper and exposure time.
struct PaperLight {
  double radiance = 0;       ///< radiance of illuminated white paper [W/(m^2 sr)]
  double exposure_time = 0;  ///< exposure time [s]
};

/// Returns the electrons in a pixel on the optical axis whose image is uniform white paper (camera equation):
/// exposure pi L t / (4 N^2 (1 + M)^2) [J/m^2], times pixel area and quantum efficiency, over the photon energy.
/// Assumes a fill factor of one and a lens without losses.
/// @param light          radiance L and exposure time t
/// @param f_number       N of the lens focused at infinity [1]
/// @param magnification  M [1]
/// @param pitch          pixel pitch [m]
/// @param wavelength     wavelength of the light [m]
/// @param efficiency     quantum efficiency, electrons per photon [1]
template <class T>
T fully_lit_electrons(PaperLight const& light, T f_number, T magnification, double pitch, double wavelength,
                      double efficiency) {
  T const working = f_number * (1.0 + magnification);
  double const photon = constant::planck * constant::speed_of_light / wavelength;
  return pi * light.radiance * light.exposure_time * pitch * pitch * efficiency / (4.0 * photon) / (working * working);
}

}  // namespace gladstone::inline sensor
