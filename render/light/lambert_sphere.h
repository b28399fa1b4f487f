#pragma once

#include <cmath>
#include <cstdint>

#include "render/base/units.h"
#include "render/base/vec.h"
#include "render/light/mie_scattering.h"

namespace gladstone::inline light {

/// Scattering cross-sections of white diffuse spheres (Lambert's law, albedo 1) that are large compared with the
/// wavelength. A view, owns no memory.
///
/// Differential cross-section d^2 / (6 pi) (sin t - t cos t), t the scattering angle (Russell, Astrophys. J. 43 (1916)
/// 173; van de Hulst, Light Scattering by Small Particles, 1957, section 8.4.2). Most light is scattered backwards; the
/// total cross-section is pi d^2 / 4.
template <class T>
struct LambertSpheres {
  T const* diameter = nullptr;  ///< particle diameters [m]

  /// Returns the differential cross-section of particle i in a direction (unit vector) for an incident wave [m^2/sr].
  GLADSTONE_HD T cross_section(std::uint64_t i, Vec3<T> direction, LightWave<T> const& wave) const {
    using std::acos;
    using std::sqrt;
    T const c = dot(direction, wave.propagation), cosine = c > T(1) ? T(1) : (c < T(-1) ? T(-1) : c);
    T const angle = acos(cosine), sine = sqrt(T(1) - cosine * cosine);
    return diameter[i] * diameter[i] * T(1 / (6 * pi)) * (sine - angle * cosine);
  }
};

}  // namespace gladstone::inline light
