#pragma once

#include <cstdint>

#include "render/light/laser_sheet.h"
#include "render/light/sources.h"

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
  /// That its random numbers are keyed by, where these are its places at the first pulse.
  GLADSTONE_HD std::uint64_t key(std::uint64_t i) const {
    return random_bits(key_of({at[i].x, at[i].y}), RandomStream::pupil, key_of({at[i].z, T(0)}), 0);
  }
  GLADSTONE_HD Vec3<T> middle(std::uint64_t i) const { return at[i]; }
  GLADSTONE_HD T reach() const { return T(0); }
  GLADSTONE_HD T area() const { return T(0); }
};

/// Where on the unit disc ray j of the particle of that key goes. Those of a scrambling come in pairs, to opposite
/// places: what changes evenly over the lens does not move their centroid.
template <class T>
GLADSTONE_HD Vec2<T> place_of_ray(BundleView<T> const& choice, std::uint64_t key, std::uint64_t j) {
  using std::sqrt;
  int const bits = choice.scrambling_bits;
  std::uint64_t const of_scrambling = j >> bits, scrambling = j & ((std::uint64_t{1} << bits) - 1);
  T u[sobol_dimensions];
  sample_coordinates(choice, key, ((of_scrambling >> 1) << bits) | scrambling, u);
  Vec2<T> const at = point_of_circle(sqrt(u[0]), u[1]);
  return of_scrambling % 2 == 1 ? -at : at;
}

/// What sends the same light into all directions.
template <class T>
struct EqualSpheres {
  GLADSTONE_HD T cross_section(std::uint64_t, Vec3<T>, LightWave<T> const&) const { return T(1); }
};

}  // namespace gladstone
