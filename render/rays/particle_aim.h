#pragma once

#include "render/rays/filled_stop.h"
#include "render/rays/ladder_view.h"

/// Aims of the rays of one particle, for CPU and GPU.
namespace gladstone::inline rays {

/// State of the aim of one particle at one pulse.
enum class AimState : int {
  none,     ///< not illuminated, or no ray passes the stop
  filled,   ///< all rays fill the stop, and none is clipped there
  unknown,  ///< rays cannot be restricted to the stop; a wide aim has to be determined
  wide,     ///< the rays cover a disc around the stop and are clipped there
};

/// Directions of the rays of one particle at one pulse, and the expected position of their light.
struct PulseAim {
  AimState state = AimState::none;
  AimMap seen, ambient;  ///< aim map with and without the medium
  Vec2d low{}, high{};   ///< approximate bounding box of the ray hits on the sensor [px]
  double spread2 = 0;    ///< variance of the hits, as FilledStop::spread2 [px^2]
};

/// Start values of a particle's computation, determined by its aims at both pulses.
struct ParticleStart {
  Vec2d origin{};       ///< whole-pixel position to which sums are relative, from the first pulse with an aim [px]
  int step = 0;         ///< first step in the sequence of ray numbers (RaysLadder)
  bool placed = false;  ///< true: rays are sent to the lens at one of the pulses, or at both

  GLADSTONE_HD void add_pulse(Vec2d position, int first_step) {
    if (!placed) origin = position;
    placed = true;
    step = first_step > step ? first_step : step;
  }
};

/// Aims at the stop without the medium. Not a template, so that the kernels of all media share its code.
GLADSTONE_SHARED_BY_KERNELS GLADSTONE_HD inline bool fill_stop_in_ambient(StopView const& stop,
                                                                          TracingOptions<double> const& options,
                                                                          Vec3d place, FilledStop& filled) {
  filled.map = paraxial_aim(stop, place);
  return fill_stop(stop, NoMedium<double>{}, options, place, filled);
}

/// Aims the rays of particle i at one pulse exactly at the stop, with and without the medium.
/// @param light_per_photon  light of an image per photon
/// @param start  updated if the rays fill the stop
/// @return aim in the state `none`, `filled`, or `unknown`; `unknown` for chief rays
template <class Sources, class Medium>
GLADSTONE_HD PulseAim aim_pulse(StopView const& stop, TracingOptions<double> const& options, Medium const& medium,
                                Sources const& particles, std::uint64_t i, LadderView const& ladder,
                                double light_per_photon, ParticleStart& start) {
  PulseAim aim;
  if (!(particles.photons[i] > 0)) return aim;
  aim.state = AimState::unknown;
  if (stop.radius == 0) return aim;
  Vec3d const place = particles.middle(i);
  FilledStop straight;
  if (!fill_stop_in_ambient(stop, options, place, straight)) return aim;
  FilledStop bent = straight;
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    if (!fill_stop(stop, medium, options, place, bent)) return aim;
  }
  aim.state = AimState::filled;
  aim.seen = bent.map;
  aim.ambient = straight.map;
  aim.low = bent.low;
  aim.high = bent.high;
  aim.spread2 = bent.spread2;
  double const weight = ray_to(particles, stop.camera.aim_plane, aim.seen, i, {}).weight;
  start.add_pulse(sum_origin(straight), ladder.step_filled(weight * light_per_photon, bent.spread2));
  return aim;
}

/// Returns the step of the ladder that a particle requires according to its rays at the given step; the same step if
/// they suffice.
/// @param aims  aims at both pulses
/// @param of_scramblings  sums of the rays through the medium
GLADSTONE_HD inline int next_particle_step(LadderView const& ladder, int step, PulseAim const* aims,
                                           RaySums const* of_scramblings, double light_per_photon) {
  bool const wide[frame_count] = {aims[0].state == AimState::wide, aims[1].state == AimState::wide};
  EdgeRaySpread const rim{{aims[0].spread2, aims[1].spread2}, {wide[0], wide[1]}};
  RayPlacement const sent = !ladder.ruled || wide[0] || wide[1] ? RayPlacement::clipped : RayPlacement::by_rule;
  return ladder.next(step, sent, rim, of_scramblings, light_per_photon / static_cast<double>(ladder.rays[step]));
}

}  // namespace gladstone::inline rays
