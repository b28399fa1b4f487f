#pragma once

#include <type_traits>

#include "render/rays/aimed_sources.h"
#include "render/rays/stop_rule.h"
#include "render/scene/camera.h"

namespace gladstone::inline rays {

/// Results of N rays of a particle at one pulse.
template <int N>
struct ParticleRays {
  RayHit<double> seen[N], ambient[N];  ///< with and without the medium
  double deflection2[N] = {};          ///< squared deflection by the medium on the aim plane [m^2]; 0 if unknown

  /// Adds ray i to the sums with and without the medium. @param origin  position to which the sums are relative [px]
  GLADSTONE_HD void enter(int i, Vec2d origin, CentroidSum<double>& of_seen, CentroidSum<double>& of_ambient) const {
    add_hit(seen[i], origin, of_seen);
    add_hit(ambient[i], origin, of_ambient);
  }
};

/// Traces the rays of a particle to N points of the stop, with and without the medium.
/// @param aim  returns the AimedRay to a point of the unit disc, for rays through the medium
/// @param ambient_aim  returns the same for rays without the medium
template <int N, class Medium, class Aim, class AmbientAim>
GLADSTONE_HD ParticleRays<N> trace_particle_rays(CameraView<double> const& camera, Medium const& medium,
                                                 TracingOptions<double> const& options, StopSamplePoint const (&to)[N],
                                                 Aim const& aim, AmbientAim const& ambient_aim) {
  auto const trace = [&](auto const& through, auto const& aimed_at, RayHit<double>(&hit)[N]) {
    Ray<double> start[N];
    double weight[N];
    for (int i = 0; i < N; ++i) {
      AimedRay<double> const aimed = aimed_at(to[i].at);
      start[i] = aimed.ray;
      weight[i] = to[i].share * aimed.weight;
    }
    trace_rays(camera, through, options, start, weight, hit);
  };
  ParticleRays<N> rays;
  trace(medium, aim, rays.seen);
  if constexpr (std::is_same_v<Medium, NoMedium<double>>) {
    for (int i = 0; i < N; ++i) rays.ambient[i] = rays.seen[i];
  } else {
    trace(NoMedium<double>{}, ambient_aim, rays.ambient);
    for (int i = 0; i < N; ++i) rays.deflection2[i] = squared_deflection(rays.ambient[i], rays.seen[i]);
  }
  return rays;
}

}  // namespace gladstone::inline rays
