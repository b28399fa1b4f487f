#pragma once

#include <cstdint>

#include "render/light/laser_sheet.h"

namespace gladstone {

/// Particles at one pulse, as the general renderer takes sources: points in space with an intensity by direction (see
/// LambertSources). A particle's disc is small beside what the lens resolves: its image is the diffraction spot, and
/// what rays make of it.
/// @tparam Scattering gives cross_section(i, direction, wave) [m^2/sr]
template <class T, class Scattering>
struct ParticleSources {
  Vec3<T> const* at = nullptr;  ///< [m]
  T const* photons = nullptr;   ///< per area, that the pulse brings [1/m^2]
  Scattering scattering;
  LaserSheet<T> sheet;
  int pulse = 0;

  GLADSTONE_HD Vec2<T> place(T, T) const { return {}; }
  GLADSTONE_HD Vec3<T> point(std::uint64_t i, Vec2<T>) const { return at[i]; }
  /// Photons that it sends into a direction (unit length) [1/sr].
  GLADSTONE_HD T intensity(std::uint64_t i, Vec3<T> direction) const {
    return photons[i] * scattering.cross_section(i, direction, sheet.wave(at[i], pulse));
  }
  GLADSTONE_HD Vec3<T> middle(std::uint64_t i) const { return at[i]; }
  GLADSTONE_HD T reach() const { return T(0); }
  GLADSTONE_HD T area() const { return T(0); }
};

/// What sends the same light into all directions.
template <class T>
struct EqualSpheres {
  GLADSTONE_HD T cross_section(std::uint64_t, Vec3<T>, LightWave<T> const&) const { return T(1); }
};

}  // namespace gladstone
