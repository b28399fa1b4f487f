#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/light/lambert_sphere.h"
#include "render/rays/filled_stop.h"
#include "render/rays/hit_spline.h"
#include "render/rays/particle_sources.h"
#include "render/rays/source_truth.h"
#include "render/scene/spot.h"

namespace gladstone::cuda {

/// How particles scatter, whichever way it is: one kernel serves them all.
struct AnyScattering {
  enum class Kind : int { equal, lambert, mie };

  Kind kind = Kind::equal;
  LambertSpheres<double> lambert;
  MieScatteringView<double> mie;

  GLADSTONE_HD double cross_section(std::uint64_t i, Vec3d direction, LightWave<double> const& wave) const {
    if (kind == Kind::mie) return mie.cross_section(i, direction, wave);
    if (kind == Kind::lambert) return lambert.cross_section(i, direction, wave);
    return EqualSpheres<double>().cross_section(i, direction, wave);
  }
};

/// What is known of the rays of one particle at one pulse.
enum class AimState : int {
  none,     ///< not lit, or no ray of it gets through
  filled,   ///< they fill the stop
  unknown,  ///< the host is to aim
  wide,     ///< they go to a disc about the stop, and are clipped there
};

/// How the rays of one particle are sent at one pulse, and where their light is expected.
struct PulseAim {
  AimState state = AimState::none;
  AimMap seen, ambient;    ///< where they go, through the medium, and without
  int window_px = 0;       ///< side of the square of pixels that its light is gathered in; 0: none
  int left = 0, top = 0;   ///< its first pixel
  double most_weight = 0;  ///< of a ray that a window takes; others are laid down one by one
};

/// Particles of a batch, and what all of them share.
struct ParticlesLaunch {
  static constexpr std::size_t windows = 1;  ///< of a block

  CameraView<double> camera;  ///< its elements on the device; the rim of its stop sharp, or smooth for wide aims
  TracingOptions<double> tracing;
  ParticleSources<double, AnyScattering> pulses[frame_count];  ///< on the device, counted from the batch's first
  std::uint64_t first = 0;                                     ///< number of the batch's first particle
  BundleView<double> choice;
  SpotView spot;
  HitSplineView spline;    ///< on the device; no share: no windows of nodes
  int most_window_px = 0;  ///< of windows of nodes
  int patch_px = 0;        ///< widest patch of pixels that a warp gathers spots in; 0: none
  DeviceImages images;     ///< may be none
  std::uint64_t rays = 1;
  bool chief_rays = false;  ///< of a camera without a stop
  double sign = 1;          ///< of the light that is laid down and of the ends that are counted

  GLADSTONE_HD int scramblings() const { return 1 << choice.scrambling_bits; }
  GLADSTONE_HD std::uint64_t shares() const { return (rays + most_rays_of_block - 1) / most_rays_of_block; }
  /// Threads of a block: a warp does where patches gather the light of few rays.
  int threads() const { return patch_px > 0 || (!images.light[0] && rays <= 64) ? 32 : 128; }

  /// Rays of a particle that one block traces; more are shared between several.
  static constexpr std::uint64_t most_rays_of_block = 16384;
};

/// What a launch gives, on the device.
struct ParticlesTraced {
  RaySums* sums;             ///< [particle][pulse][share][scrambling]: seen through the medium, and without it
  double* bend2;             ///< [particle][pulse]: square of the furthest that the medium moved a ray [m^2]
  unsigned long long* ends;  ///< [pulse][status], counted on
};

/// The square of pixels that light between two places needs, so that a tenth more finds room, too.
GLADSTONE_HD inline void place_window(ParticlesLaunch const& launch, Vec2d low, Vec2d high, PulseAim& aim) {
  Vec2d const more = 0.05 * (high - low);
  low -= more;
  high += more;
  double const furthest = 1e7;
  if (!(low.x > -furthest && low.y > -furthest && high.x < furthest && high.y < furthest)) return;
  auto const pixel = [](double p) { return static_cast<int>(floor(p + 0.5)); };
  int const first_x = pixel(low.x), first_y = pixel(low.y);
  int const wide = pixel(high.x) - first_x, tall = pixel(high.y) - first_y, wanted = wide > tall ? wide : tall;
  if (launch.patch_px > 0) {
    int const half = launch.spot.half_width(), side = wanted + 2 * half + 1;
    aim.window_px = side < launch.patch_px ? side : launch.patch_px;
    aim.left = first_x - half;
    aim.top = first_y - half;
  } else if (launch.most_window_px > 0) {
    // pixels for the nodes about a hit
    int const side = wanted + 4;
    aim.window_px = side < launch.most_window_px ? side : launch.most_window_px;
    aim.left = first_x + (wide - aim.window_px) / 2;
    aim.top = first_y + (tall - aim.window_px) / 2;
  }
}

/// A ray of a particle of either memory to a place of the unit disc.
template <class Sources>
GLADSTONE_HD AimedRay<double> aimed_ray(ParticlesLaunch const& launch, Sources const& sources, AimMap const& map,
                                        std::uint64_t i, Vec2d at) {
  // chief rays are worth a square metre
  if (launch.chief_rays) return ray_to_plane(sources, launch.camera.aim_plane, map.centre, 1.0, i);
  return ray_to(sources, launch.camera.aim_plane, map, i, at);
}

/// The most that a ray of a particle is expected to weigh: four times what those to the middle and to the rim do. What
/// is heavier is laid down by itself.
template <class Sources>
GLADSTONE_HD double weight_expected(ParticlesLaunch const& launch, Sources const& sources, AimMap const& map,
                                    std::uint64_t i) {
  double most = 0;
  GLADSTONE_RAY_BY_RAY
  for (int k = 0; k <= rim_rays; ++k) {
    Vec2d const at = k < rim_rays ? point_of_circle(1.0, static_cast<double>(k) / rim_rays) : Vec2d{};
    double const weight = aimed_ray(launch, sources, map, i, at).weight;
    if (weight > most) most = weight;
  }
  return 4 * most;
}

/// The widest windows that launches may have: not of any particle, so that none depends on others.
int widest_particle_window_px(ParticlesLaunch const& launch, DeviceMedium<double> const& medium);

/// Aims at the stop for both pulses of `count` particles. @param stop its elements on the device
/// @param unknown counts those that the host is to aim
void aim_particles(StopView const& stop, ParticlesLaunch const& launch, DeviceMedium<double> const& medium,
                   std::uint64_t count, PulseAim* aims, Vec2d* origins, unsigned long long* unknown);

/// Traces all rays of particles, a block for each share of a particle at a pulse: sums, ends, light. Sums have an order
/// and light is in whole units, so that results hang on nothing but the particle.
/// @param state of the aims that are traced @param listed numbers of the aims; null: all of `count`
void trace_particles(ParticlesLaunch const& launch, DeviceMedium<double> const& medium, AimState state,
                     PulseAim const* aims, Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                     ParticlesTraced const& traced);

/// What the camera sees of particles, from the sums over their rays. @param ambient null: nothing bends rays
void see_particles(ParticlesLaunch const& launch, PulseAim const* aims, Vec2d const* origins, RaySums const* sums,
                   std::uint64_t count, DotTruth* truth, DotTruth* ambient);

}  // namespace gladstone::cuda
