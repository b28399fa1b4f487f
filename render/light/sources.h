#pragma once

#include <cmath>
#include <cstdint>

#include "render/base/host_device.h"
#include "render/base/random.h"
#include "render/base/sobol.h"
#include "render/base/sobol_order.h"
#include "render/base/vec.h"

namespace gladstone::inline light {

/// Shape of the light sources of a target.
enum class SourceShape : int {
  disc,    ///< uniform disc; a point if its size is zero
  square,  ///< uniform square: one pixel of an image target
};

/// View of the light sources on the target plane, as used by the ray tracer.
template <class T>
struct SourcesView {
  Vec2<T> const* centre = nullptr;  ///< centres, world X and Y [m]
  T const* radiance = nullptr;      ///< radiance relative to a white target [1]; null: all one
  std::uint64_t count = 0;
  T plane_z{};    ///< Z of the target plane [m]
  T half_size{};  ///< radius of a disc, half the side of a square [m]
  SourceShape shape = SourceShape::disc;
};

/// Returns the key of a source's random numbers. It depends on the source's position rounded to a nanometre only, not
/// on the other sources. Coordinates are clamped to +-9e9 m, the range of 64-bit nanometres.
/// @param centre  centre of the source [m]
GLADSTONE_HD inline std::uint64_t random_key(Vec2d centre) {
  using std::floor;
  auto const nanometres = [](double at) {
    constexpr double farthest = 9e18;  // largest coordinate [nm], within the range of a 64-bit integer
    double const whole = floor(1e9 * at + 0.5);
    double const within = whole < -farthest ? -farthest : (whole < farthest ? whole : farthest);
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(within));
  };
  return random_bits(nanometres(centre.x), RandomStream::pupil, nanometres(centre.y), 0);
}

enum class PupilSampling : int { sobol, random };

/// Maximum number of independent Owen scramblings per source. The rays of a source are divided among the scramblings,
/// and the scatter between their means estimates the error of the overall mean.
inline constexpr int most_scramblings = 8;
/// Returns the binary logarithm of the number of scramblings for a number of rays per source. More scramblings give a
/// better error estimate, but each has fewer points, which increases the error of the mean: with 8 scramblings by 5 %
/// at 64 rays per source. There are 4 scramblings from 512 rays on, and 4 to 1 below 8 rays.
GLADSTONE_HD constexpr int scrambling_bits(std::uint64_t rays) {
  if (rays >= 8) return rays < 512 ? 3 : 2;
  return rays >= 4 ? 2 : (rays >= 2 ? 1 : 0);
}

/// Returns the number of points per scrambling for which both rays of a pair (AimedRay of opposite source positions)
/// are traced.
GLADSTONE_HD constexpr std::uint32_t complete_points(std::uint64_t rays, int scrambling_bits) {
  return static_cast<std::uint32_t>(rays >> (scrambling_bits + 1));
}

/// Sampling of the rays of a source. Both frames use the same sample points.
struct BundleView {
  std::uint64_t seed = 0;
  PupilSampling sampling = PupilSampling::sobol;
  int scrambling_bits = 0;           ///< bits b of the number of scramblings 2^b; ray j uses point j / 2^b (rounded
                                     ///< down) of scrambling j modulo 2^b
  std::uint32_t ordered_points = 0;  ///< number of leading points of each scrambling that ordered_point() permutes
};

/// Computes the sample coordinates of a ray, each in [0, 1): pupil radius^2 and angle, source radius^2 and angle.
template <class T>
GLADSTONE_HD void sample_coordinates(BundleView const& bundle, std::uint64_t source, std::uint64_t ray,
                                     T (&u)[sobol_dimensions]) {
  if (bundle.sampling == PupilSampling::random) {
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
      std::uint64_t const bits = random_bits(bundle.seed, RandomStream::pupil, source,
                                             ray * sobol_dimensions + static_cast<std::uint64_t>(dimension));
      u[dimension] = T(to_unit(bits));
    }
    return;
  }
  std::uint64_t const scrambling = ray & ((std::uint64_t{1} << bundle.scrambling_bits) - 1);
  std::uint64_t const low = random_bits(bundle.seed, RandomStream::pupil, source, 2 * scrambling);
  std::uint64_t const high = random_bits(bundle.seed, RandomStream::pupil, source, 2 * scrambling + 1);
  std::uint32_t const seeds[sobol_dimensions] = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(low >> 32),
                                                 static_cast<std::uint32_t>(high),
                                                 static_cast<std::uint32_t>(high >> 32)};
  std::uint32_t const index = ordered_point(static_cast<std::uint32_t>(ray >> bundle.scrambling_bits),
                                            bundle.ordered_points, seeds[0], seeds[1]);
  std::uint32_t point[sobol_dimensions];
  sobol_point(index, point);
  for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
    std::uint32_t const x = owen_scramble(point[dimension], seeds[dimension]);
    u[dimension] = T((static_cast<double>(x) + 0.5) * 0x1p-32);
  }
}

/// Returns the point of a circle about the origin at a polar angle given as a fraction of a full turn.
template <class T>
GLADSTONE_HD Vec2<T> point_on_circle(T radius, T turn) {
  using std::cos;
  using std::sin;
  constexpr double two_pi = 6.28318530717958647693;
  T const angle = T(two_pi) * turn;
  return {radius * cos(angle), radius * sin(angle)};
}

}  // namespace gladstone::inline light
