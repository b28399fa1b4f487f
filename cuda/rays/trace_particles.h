#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_images.h"
#include "cuda/rays/device_medium.h"
#include "render/light/lambert_sphere.h"
#include "render/rays/filled_stop.h"
#include "render/rays/hit_spline.h"
#include "render/rays/particle_sources.h"
#include "render/rays/ray_need.h"
#include "render/rays/source_truth.h"
#include "render/rays/stop_rule.h"
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
  AimMap seen, ambient;  ///< where they go, through the medium, and without
  Vec2d low{}, high{};   ///< about between which they end on the sensor [px]
  double spread2 = 0;    ///< as FilledStop's
};

/// The numbers of rays that particles may take (RaysLadder), on the device.
struct LadderView {
  static constexpr int most_steps = 16;

  RayGoal goal;
  double light_per_photon = 0;  ///< of images
  int steps = 1;
  int first_clipped = 0;  ///< that particles begin at whose rays are clipped
  bool ruled = false;     ///< rays that fill the stop go by rules
  std::uint64_t rays[most_steps] = {};
  int scrambling_bits[most_steps] = {};
  std::uint64_t sums_a_pulse = 1;  ///< of one particle: room for those of any step

  /// As RaysLadder::at_least.
  GLADSTONE_HD int at_least(double wanted) const {
    int step = 0;
    while (step + 1 < steps && static_cast<double>(rays[step]) < wanted) ++step;
    return step;
  }
  /// As ParticleLaunches::step_filled.
  GLADSTONE_HD int step_filled(double light, double spread2) const {
    return at_least(rays_for_spread(goal, ruled ? RaysSent::by_rule : RaysSent::clipped, light, spread2,
                                    static_cast<double>(rays[0])));
  }
  /// As RaysLadder::next.
  GLADSTONE_HD int next(int step, RaysSent sent, RimSpread const& rim, RaySums const* of_scramblings) const {
    if (step + 1 >= steps) return step;
    auto const here = static_cast<double>(rays[step]);
    double const asked =
        rays_asked(goal, sent, rim, of_scramblings, 1 << scrambling_bits[step], here, light_per_photon / here);
    if (!(asked > here)) return step;
    int const found = at_least(asked);
    return found > step ? found : step + 1;
  }
};

/// Particles of a batch, and what those share that take so many rays.
struct ParticlesLaunch {
  static constexpr std::size_t windows = 1;  ///< of a block

  CameraView<double> camera;  ///< its elements on the device; the rim of its stop sharp, or smooth for wide aims
  TracingOptions<double> tracing;
  ParticleSources<double, AnyScattering> pulses[frame_count];  ///< on the device, counted from the batch's first
  std::uint64_t first = 0;                                     ///< number of the batch's first particle
  BundleView<double> choice;
  StopRuleView rule;  ///< on the device; that rays which fill the stop go by, if there is one
  SpotView spot;
  HitSplineView spline;    ///< on the device; no share: no windows of nodes
  int most_window_px = 0;  ///< of windows of nodes
  int patch_px = 0;        ///< widest square of pixels that a warp lays spots down in together; 0: none
  DeviceImages images;     ///< may be none
  std::uint64_t rays = 1;
  std::uint64_t sums_a_pulse = 1;  ///< from one aim's sums to the next one's
  bool chief_rays = false;         ///< of a camera without a stop
  double sign = 1;                 ///< of the light that is laid down and of the ends that are counted

  GLADSTONE_HD int scramblings() const { return 1 << choice.scrambling_bits; }
  GLADSTONE_HD static std::uint64_t shares_of(std::uint64_t rays) {
    return (rays + most_rays_of_block - 1) / most_rays_of_block;
  }
  GLADSTONE_HD std::uint64_t shares() const { return shares_of(rays); }
  /// Whether a warp traces all rays of a particle: so few that no window of nodes pays for them.
  bool few_rays() const { return patch_px > 0 || (!images.light[0] && rays <= 64); }
  /// Lanes of a warp that a particle has then: a power of two.
  GLADSTONE_HD int lanes() const {
    int most = 32;
    while (static_cast<std::uint64_t>(most / 2) >= rays) most /= 2;
    return most;
  }

  /// Rays of a particle that one block traces; more are shared between several.
  static constexpr std::uint64_t most_rays_of_block = 16384;
};

/// What a launch gives, on the device.
struct ParticlesTraced {
  RaySums* sums;   ///< [particle][pulse], of each [share][scrambling]: seen through the medium, and without it
  double* moved2;  ///< [particle][pulse]: square of the furthest that the medium moved a ray [m^2]
  unsigned long long* ends;  ///< [pulse][status], counted on
};

/// A square of pixels that the light of a particle at a pulse is gathered in.
struct LightSquare {
  int side = 0;           ///< 0: none
  int left = 0, top = 0;  ///< its first pixel
};

/// The square of pixels that the light of an aim needs, so that a tenth more finds room, too.
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
  int const side = wanted + 4 < launch.most_window_px ? wanted + 4 : launch.most_window_px;  // nodes about a hit
  return {side, first_x + (wide - side) / 2, first_y + (tall - side) / 2};
}

/// A ray of a particle of either memory to a place of the unit disc.
template <class Sources>
GLADSTONE_HD AimedRay<double> aimed_ray(ParticlesLaunch const& launch, Sources const& sources, AimMap const& map,
                                        std::uint64_t i, Vec2d at) {
  // chief rays are worth a square metre
  if (launch.chief_rays) return ray_to_plane(sources, launch.camera.aim_plane, map.centre, 1.0, i);
  return ray_to(sources, launch.camera.aim_plane, map, i, at);
}

/// A window takes rays that are so many times heavier than the heaviest of those to the middle and to the rim; what is
/// heavier still is laid down by itself.
inline constexpr double heavier_in_window = 4;
/// What ray k of these weighs, k up to rim_rays.
GLADSTONE_HD inline double weight_of_rim(ParticlesLaunch const& launch, PulseAim const& aim, int pulse, std::uint64_t i,
                                         int k) {
  Vec2d const at = k < rim_rays ? point_of_circle(1.0, static_cast<double>(k) / rim_rays) : Vec2d{};
  return aimed_ray(launch, launch.pulses[pulse], aim.seen, i, at).weight;
}

/// The widest windows that launches may have: not of any particle, so that none depends on others.
int widest_particle_window_px(ParticlesLaunch const& launch, DeviceMedium<double> const& medium);

/// What becomes of the particles of a batch, on the device.
struct ParticleSteps {
  int* step;            ///< of the ladder, that a particle is at
  int* next;            ///< that it is to go on to; the same: it has what it needs
  int* chosen;          ///< whether it is to be listed: it is aimed at; or it goes on
  unsigned int* count;  ///< [step], and of all aims that the host is to find
};

/// Aims at the stop for both pulses of `count` particles, and tells the step that each begins at. @param stop its
/// elements on the device @param launch of any step
void aim_particles(StopView const& stop, ParticlesLaunch const& launch, LadderView const& ladder,
                   DeviceMedium<double> const& medium, std::uint64_t count, PulseAim* aims, Vec2d* origins,
                   ParticleSteps const& steps);

/// Lists by their steps the aims of chosen particles that fill the stop. @param at their steps, or those that they go
/// on to @param listed [step], of each room for all aims; their order is none, nor does anything hang on it
void list_particles(LadderView const& ladder, PulseAim const* aims, int const* at, ParticleSteps const& steps,
                    std::uint64_t count, std::uint32_t* listed);

/// Traces all rays of listed particles, a block for each share of a particle at a pulse, or a warp for several
/// particles of few rays: sums, ends, light. Sums have
/// an order and light is in whole units, so that results hang on nothing but the particle.
/// @param state of the aims that are traced @param listed numbers of the aims, `count` of them
void trace_particles(ParticlesLaunch const& launch, DeviceMedium<double> const& medium, AimState state,
                     PulseAim const* aims, Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                     ParticlesTraced const& traced);

/// The same by warps. @pre launch.few_rays()
void trace_few_rays(ParticlesLaunch const& launch, DeviceMedium<double> const& medium, AimState state,
                    PulseAim const* aims, Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                    ParticlesTraced const& traced);

/// What the camera sees of particles, from the sums over their rays, and which of them need more of these.
/// @param ambient null: nothing bends rays
void see_particles(LadderView const& ladder, PulseAim const* aims, Vec2d const* origins, RaySums const* sums,
                   std::uint64_t count, ParticleSteps const& steps, DotTruth* truth, DotTruth* ambient);

}  // namespace gladstone::cuda
