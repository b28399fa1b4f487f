#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "render/base/host_device.h"
#include "render/base/random.h"
#include "render/base/ray.h"
#include "render/base/sobol.h"

namespace gladstone {

/// Outline of the sources of a target.
enum class SourceShape : int {
  disc,    ///< a uniform disc; of zero size: a point
  square,  ///< a uniform square: one pixel of a picture
};

/// The sources on the target's plane, as rays see them: a view that owns nothing.
template <class T>
struct SourcesView {
  Vec2<T> const* centre = nullptr;  ///< [m], world X and Y
  T const* radiance = nullptr;      ///< relative to a white target [1]; null: all one
  std::uint64_t count = 0;
  T plane_z{};    ///< [m]
  T half_size{};  ///< radius of a disc, half the side of a square [m]
  SourceShape shape = SourceShape::disc;
};

/// What a source's random numbers are keyed by: its place, to a nanometre, whatever else is in the scene. Beyond 9e9 m,
/// where whole numbers of nanometres end, all places of a side have one key.
GLADSTONE_HD inline std::uint64_t key_of(Vec2d centre) {
  using std::floor;
  auto const nanometres = [](double at) {
    constexpr double farthest = 9e18;  // [nm], within the range of a 64-bit integer
    double const whole = floor(1e9 * at + 0.5);
    double const within = whole < -farthest ? -farthest : (whole < farthest ? whole : farthest);
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(within));
  };
  return random_bits(nanometres(centre.x), RandomStream::pupil, nanometres(centre.y), 0);
}

enum class PupilSampling : int { sobol, random };

/// The most independent scramblings that a source's rays are dealt to, and the binary logarithm of their number for so
/// many rays. Their scatter tells how good the rays' mean is: the better, the more there are. But a scrambling's points
/// are the better, the more of them there are: eight cost little up to some hundred rays (5 % of truth's scatter at
/// 64), beyond it is four. A handful of rays has fewer.
inline constexpr int most_scramblings = 8;
GLADSTONE_HD constexpr int scrambling_bits(std::uint64_t rays) {
  if (rays >= 8) return rays < 512 ? 3 : 2;
  return rays >= 4 ? 2 : (rays >= 2 ? 1 : 0);
}

/// Which points of a source and of the pupil a ray joins. Both frames use the same points.
template <class T>
struct BundleView {
  T lens_z{};        ///< plane of the pupil [m]
  T pupil_radius{};  ///< of the disc that rays are sent to: the stop's and a margin; 0: chief rays [m]
  std::uint64_t seed = 0;
  PupilSampling sampling = PupilSampling::sobol;
  int scrambling_bits = 0;  ///< ray j is point j >> bits of a source's scrambling j mod 2^bits
};

/// A ray as it leaves its source.
template <class T>
struct EmittedRay {
  Ray<T> ray;
  Vec2<T> pupil;  ///< where the straight ray meets the lens plane [m]
  T weight{};     ///< radiance cos^4 [1]: what a Lambertian source sends through equal areas of the pupil
};

/// Four coordinates in [0, 1) of ray j of source i: pupil radius^2 and angle, source radius^2 and angle.
template <class T>
GLADSTONE_HD void sample_coordinates(BundleView<T> const& bundle, std::uint64_t source, std::uint64_t ray,
                                     T (&u)[sobol_dimensions]) {
  if (bundle.sampling == PupilSampling::random) {
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
      std::uint64_t const bits = random_bits(bundle.seed, RandomStream::pupil, source,
                                             ray * sobol_dimensions + static_cast<std::uint64_t>(dimension));
      u[dimension] = T(to_unit(bits));
      if (u[dimension] >= T(1)) u[dimension] = T(0);  // only single precision rounds up to one
    }
    return;
  }
  std::uint64_t const scrambling = ray & ((std::uint64_t{1} << bundle.scrambling_bits) - 1);
  std::uint64_t const low = random_bits(bundle.seed, RandomStream::pupil, source, 2 * scrambling);
  std::uint64_t const high = random_bits(bundle.seed, RandomStream::pupil, source, 2 * scrambling + 1);
  std::uint32_t const seeds[sobol_dimensions] = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(low >> 32),
                                                 static_cast<std::uint32_t>(high),
                                                 static_cast<std::uint32_t>(high >> 32)};
  std::uint32_t point[sobol_dimensions];
  sobol_point(static_cast<std::uint32_t>(ray >> bundle.scrambling_bits), point);
  for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
    std::uint32_t const x = owen_scramble(point[dimension], seeds[dimension]);
    if constexpr (sizeof(T) > sizeof(float)) {
      u[dimension] = T((static_cast<double>(x) + 0.5) * 0x1p-32);
    } else {
      u[dimension] = (static_cast<T>(x >> 8) + T(0.5)) * T(0x1p-24);
    }
  }
}

/// The point of a circle at some share of a turn.
template <class T>
GLADSTONE_HD Vec2<T> point_of_circle(T radius, T turn) {
  using std::cos;
  using std::sin;
#if defined(__CUDA_ARCH__)
  if constexpr (std::is_same_v<T, float>) {
    T sine, cosine;
    sincospif(2.0f * turn, &sine, &cosine);
    return {radius * cosine, radius * sine};
  }
#endif
  constexpr double two_pi = 6.28318530717958647693;
  T const angle = T(two_pi) * turn;
  return {radius * cos(angle), radius * sin(angle)};
}

/// Sends ray j of source i towards the pupil.
template <class T>
GLADSTONE_HD EmittedRay<T> emit(SourcesView<T> const& sources, BundleView<T> const& bundle, std::uint64_t source,
                                std::uint64_t ray) {
  using std::sqrt;
  T u[sobol_dimensions];
  sample_coordinates(bundle, source, ray, u);

  Vec2<T> offset;
  if (sources.shape == SourceShape::disc) {
    offset = point_of_circle(sources.half_size * sqrt(u[2]), u[3]);
  } else {
    offset = {sources.half_size * (T(2) * u[2] - T(1)), sources.half_size * (T(2) * u[3] - T(1))};
  }
  EmittedRay<T> emitted;
  emitted.pupil = point_of_circle(bundle.pupil_radius * sqrt(u[0]), u[1]);
  Vec2<T> const start = sources.centre[source] + offset;
  Vec3<T> const way{emitted.pupil.x - start.x, emitted.pupil.y - start.y, bundle.lens_z - sources.plane_z};
  T const far = length(way);
  emitted.ray = {{start.x, start.y, sources.plane_z}, way / far};
  T const cosine2 = emitted.ray.direction.z * emitted.ray.direction.z;
  T const radiance = sources.radiance ? sources.radiance[source] : T(1);
  emitted.weight = radiance * cosine2 * cosine2;
  return emitted;
}

}  // namespace gladstone
