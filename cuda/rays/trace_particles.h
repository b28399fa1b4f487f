#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/light/lambert_sphere.h"
#include "render/rays/hit_spline.h"
#include "render/rays/particle_aim.h"
#include "render/rays/particle_rays.h"
#include "render/rays/particle_sources.h"
#include "render/rays/source_truth.h"
#include "render/rays/stop_rule.h"
#include "render/scene/spot.h"

namespace gladstone::cuda::inline rays {

/// Scattering model of the particles, selected at run time, so that one kernel suffices.
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

/// Numbers of rays among which that of each particle is chosen, on the device.
struct ParticleLadder : LadderView {
  double light_per_photon = 0;       ///< light in the images per photon
  std::uint64_t sums_per_pulse = 1;  ///< number of RaySums of one particle and pulse: shares times scramblings, maximum
                                     ///< over all elements of `rays`
};

/// Particles of a batch, and data common to those with the same number of rays.
struct ParticlesLaunch {
  static constexpr std::size_t windows = 1;  ///< number of windows of spline nodes (HitWindow) per block

  CameraView<double> camera;  ///< elements in device memory; the stop has a sharp edge, or a smooth one for wide aims
  TracingOptions<double> tracing;
  ParticleSources<double, AnyScattering>
      pulses[frame_count];  ///< particles at each pulse in device memory, indexed from the batch's first particle
  std::uint64_t first = 0;  ///< index of the batch's first particle in the scene
  BundleView choice;
  StopRuleView rule;  ///< quadrature rule of rays that fill the stop, if any, in device memory
  SpotView spot;
  HitSplineView spline;    ///< weights of the spline in device memory; spline.share null: no windows of spline nodes
  int most_window_px = 0;  ///< maximum side of a window of spline nodes [px]
  int patch_px = 0;        ///< widest square of pixels in which a warp accumulates PSFs; 0: none
  DeviceImages images;     ///< images to which light is added; may be empty
  std::uint64_t rays = 1;
  std::uint64_t sums_per_pulse = 1;  ///< number of RaySums stored for each particle and pulse
  bool chief_rays = false;           ///< the camera has no stop: trace chief rays only
  double sign = 1;                   ///< sign of the light and of the ray counts; -1 removes those of an earlier launch

  GLADSTONE_HD int scramblings() const { return 1 << choice.scrambling_bits; }
  GLADSTONE_HD static std::uint64_t shares_of(std::uint64_t rays) {
    return (rays + max_rays_per_block - 1) / max_rays_per_block;
  }
  GLADSTONE_HD std::uint64_t shares() const { return shares_of(rays); }
  /// Returns whether a warp traces all rays of a particle, because a window of spline nodes would not be efficient.
  bool few_rays() const { return patch_px > 0 || (!images.light[0] && rays <= 64); }
  /// Returns the number of lanes that trace a particle if few_rays(): the smallest power of two that is at least
  /// `rays`, at most 32.
  GLADSTONE_HD int lanes() const {
    int most = 32;
    while (static_cast<std::uint64_t>(most / 2) >= rays) most /= 2;
    return most;
  }

  /// Maximum number of rays of a particle traced by one block; larger numbers are divided among several blocks.
  static constexpr std::uint64_t max_rays_per_block = 16384;
};

/// Output of a launch, in device memory.
struct ParticlesTraced {
  RaySums* sums;             ///< [particle][pulse][share][scrambling]: sums with and without the medium
  double* moved2;            ///< [particle][pulse]: largest squared displacement of a ray by the medium [m^2]
  unsigned long long* ends;  ///< ray counts to be incremented: [pulse][status]
};

/// Square of pixels in which the light of a particle at one pulse is accumulated.
struct LightSquare {
  int side = 0;           ///< side of the square [px]; 0: no square
  int left = 0, top = 0;  ///< first pixel of the square
};

/// Returns the square of pixels for the light of an aim, with a margin of a tenth.
GLADSTONE_HD inline LightSquare light_square(ParticlesLaunch const& launch, PulseAim const& aim) {
  Vec2d const more = 0.05 * (aim.high - aim.low), low = aim.low - more, high = aim.high + more;
  double const furthest = 1e7;
  if (!(low.x > -furthest && low.y > -furthest && high.x < furthest && high.y < furthest)) return {};
  auto const pixel = [](double p) { return static_cast<int>(floor(p + 0.5)); };
  int const first_x = pixel(low.x), first_y = pixel(low.y);
  int const wide = pixel(high.x) - first_x, tall = pixel(high.y) - first_y, wanted = wide > tall ? wide : tall;
  if (launch.patch_px > 0) {
    int const half = launch.spot.half_width(), side = wanted + 2 * half + 1;
    return {side < launch.patch_px ? side : launch.patch_px, first_x - half, first_y - half};
  }
  if (launch.most_window_px == 0) return {};
  int const side =
      wanted + 4 < launch.most_window_px ? wanted + 4 : launch.most_window_px;  // four more pixels for the spline nodes
                                                                                // around a ray
  return {side, first_x + (wide - side) / 2, first_y + (tall - side) / 2};
}

/// Returns the ray of a particle to a point of the unit disc. @param sources  in host or device memory
template <class Sources>
GLADSTONE_HD AimedRay<double> aimed_ray(ParticlesLaunch const& launch, Sources const& sources, AimMap const& map,
                                        std::uint64_t i, Vec2d at) {
  // Chief rays represent an aperture of one square metre.
  if (launch.chief_rays) return ray_to_plane(sources, launch.camera.aim_plane, map.centre, 1.0, i);
  return ray_to(sources, launch.camera.aim_plane, map, i, at);
}

/// Ratio of the maximum weight of a ray in a window of spline nodes to the largest weight of the central ray and the
/// rim rays [1]. The PSFs of rays with a larger weight are added to the image one by one.
inline constexpr double heavier_in_window = 4;
/// Returns the weight of ray k: a ray to the rim for k < rim_rays, the central ray for k = rim_rays.
GLADSTONE_HD inline double weight_of_rim(ParticlesLaunch const& launch, PulseAim const& aim, int pulse, std::uint64_t i,
                                         int k) {
  Vec2d const at = k < rim_rays ? point_on_circle(1.0, static_cast<double>(k) / rim_rays) : Vec2d{};
  return aimed_ray(launch, launch.pulses[pulse], aim.seen, i, at).weight;
}

/// Returns the maximum side of windows [px]. It does not depend on the particles, so that the result of one is
/// independent of the others.
int widest_particle_window_px(ParticlesLaunch const& launch, DeviceMedium const& medium);

/// Progress of the particles of a batch, in device memory.
struct ParticleSteps {
  int* step;            ///< current step of each particle in the sequence of ray numbers (RaysLadder)
  int* next;            ///< next step of each particle; equal to `step`: the particle has enough rays
  int* chosen;          ///< true: the particle is to be listed, because it has been aimed or needs more rays
  unsigned int* count;  ///< [step] number of listed pairs of particle and pulse; last element: number of pairs whose
                        ///< directions the host determines, or of particles that need more rays
};

/// Determines the directions of the rays of `count` particles towards the stop at both laser pulses, and the first step
/// of RaysLadder of each particle.
/// @param stop  stop with its elements in device memory
/// @param launch  launch of any step
void aim_particles(StopView const& stop, ParticlesLaunch const& launch, ParticleLadder const& ladder,
                   DeviceMedium const& medium, std::uint64_t count, PulseAim* aims, Vec2d* origins,
                   ParticleSteps const& steps);

/// Lists, by number of rays, the chosen particles (with their pulse) whose rays fill the stop.
/// @param at  step of each particle
/// @param listed  output: [step][frame_count * count], in arbitrary order, which does not affect the results
void list_particles(ParticleLadder const& ladder, PulseAim const* aims, int const* at, ParticleSteps const& steps,
                    std::uint64_t count, std::uint32_t* listed);

/// Traces all rays of the listed particles: one block per share of a particle at one pulse, or one warp for several
/// particles with few rays. Adds their light, sums and status counts. Sums have a fixed order and light is in whole
/// units, so that the result of a particle is independent of the others.
/// @param state  only elements of `aims` in this state are traced
/// @param listed  `count` indices in `aims`
void trace_particles(ParticlesLaunch const& launch, DeviceMedium const& medium, AimState state, PulseAim const* aims,
                     Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                     ParticlesTraced const& traced);

/// Like trace_particles(), by warps. @pre launch.few_rays()
void trace_few_rays(ParticlesLaunch const& launch, DeviceMedium const& medium, AimState state, PulseAim const* aims,
                    Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                    ParticlesTraced const& traced);

/// Computes the truth of the particles from the sums over their rays, and determines which of them need more rays.
/// @param ambient  null: no medium
void see_particles(ParticleLadder const& ladder, PulseAim const* aims, Vec2d const* origins, RaySums const* sums,
                   std::uint64_t count, ParticleSteps const& steps, DotTruth* truth, DotTruth* ambient);

}  // namespace gladstone::cuda::inline rays
