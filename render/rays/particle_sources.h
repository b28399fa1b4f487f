#pragma once

#include <cstdint>

#include "render/light/laser_sheet.h"
#include "render/light/sources.h"

namespace gladstone::inline rays {

/// Particles at one pulse, in the form required by the general renderer: points in space with an angular intensity (see
/// LambertSources). A particle is much smaller than the resolution of the lens: its image is the PSF at the positions
/// where its rays land.
/// @tparam Scattering  provides cross_section(i, direction, wave) [m^2/sr]
template <class T, class Scattering>
struct ParticleSources {
  Vec3<T> const* at = nullptr;  ///< positions [m]
  T const* photons = nullptr;   ///< photon fluence of the pulse at each particle [1/m^2]
  Scattering scattering;
  LaserSheet<T> sheet;
  int pulse = 0;

  GLADSTONE_HD Vec2<T> place(T, T) const { return {}; }
  GLADSTONE_HD Vec3<T> point(std::uint64_t i, Vec2<T>) const { return at[i]; }
  /// Returns the intensity in a direction (unit vector) [photons/sr].
  GLADSTONE_HD T intensity(std::uint64_t i, Vec3<T> direction) const {
    return photons[i] * scattering.cross_section(i, direction, sheet.wave(at[i], pulse));
  }
  /// Key of the particle's random numbers. @pre the positions are those at the first pulse
  GLADSTONE_HD std::uint64_t key(std::uint64_t i) const {
    return random_bits(random_key({at[i].x, at[i].y}), RandomStream::pupil, random_key({at[i].z, T(0)}), 0);
  }
  GLADSTONE_HD Vec3<T> middle(std::uint64_t i) const { return at[i]; }
  GLADSTONE_HD T reach() const { return T(0); }
  GLADSTONE_HD T area() const { return T(0); }
};

/// Returns the point of the unit disc to which ray j of the particle with this key is sent. Rays of a scrambling come
/// in pairs at opposite points, so that quantities that vary linearly over the lens do not shift their centroid.
GLADSTONE_HD inline Vec2d sample_stop_point(BundleView const& choice, std::uint64_t key, std::uint64_t j) {
  using std::sqrt;
  int const bits = choice.scrambling_bits;
  std::uint64_t const of_scrambling = j >> bits, scrambling = j & ((std::uint64_t{1} << bits) - 1);
  double u[sobol_dimensions];
  sample_coordinates(choice, key, ((of_scrambling >> 1) << bits) | scrambling, u);
  Vec2d const at = point_on_circle(sqrt(u[0]), u[1]);
  return of_scrambling % 2 == 1 ? -at : at;
}

/// Scattering of equal intensity in all directions.
template <class T>
struct EqualSpheres {
  GLADSTONE_HD T cross_section(std::uint64_t, Vec3<T>, LightWave<T> const&) const { return T(1); }
};

}  // namespace gladstone::inline rays
