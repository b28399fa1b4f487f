#pragma once

#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda::inline rays {

/// Ray of a particle at one pulse, with and without the medium.
struct ParticleRay {
  RayHit<double> seen, ambient;
  double moved2 = 0;  ///< squared displacement by the medium in the aim plane [m^2]

  /// Adds the position on the sensor relative to the particle's origin to the sums.
  __device__ void enter(Vec2d origin, RaySums& sums) const {
    add(seen, origin, sums.hits[0]);
    add(ambient, origin, sums.hits[1]);
  }

 private:
  __device__ static void add(RayHit<double> const& hit, Vec2d origin, CentroidSum<double>& sum) {
    if (hit.weight != 0) sum.add(hit.pixel - origin, hit.weight, reaches_sensor_plane(hit.status));
  }
};

/// Traces ray j. @param key  key of the particle's random numbers
template <class Medium>
__device__ ParticleRay trace_particle_ray(ParticlesLaunch const& launch, CameraView<double> const& camera,
                                          Medium const& medium, PulseAim const& aim, int pulse, std::uint64_t particle,
                                          std::uint64_t key, std::uint64_t j) {
  auto const& particles = launch.pulses[pulse];
  StopRuleView const rule = aim.state == AimState::filled ? launch.rule : StopRuleView{};
  StopSamplePoint const to = sample_stop_point(rule, launch.choice, key, j);
  AimedRay<double> const aimed = aimed_ray(launch, particles, aim.seen, particle, to.at);
  ParticleRay ray;
  ray.seen = trace_ray(camera, medium, launch.tracing, aimed.ray, to.share * aimed.weight);
  ray.ambient = ray.seen;
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    AimedRay<double> const straight = aimed_ray(launch, particles, aim.ambient, particle, to.at);
    ray.ambient = trace_ray(camera, NoMedium<double>{}, launch.tracing, straight.ray, to.share * straight.weight);
    if (ray.seen.status <= RayStatus::vignetted && ray.ambient.status <= RayStatus::vignetted) {
      Vec2d const shift = ray.seen.at_lens - ray.ambient.at_lens;
      ray.moved2 = dot(shift, shift);
    }
  }
  return ray;
}

/// Stores the larger of two non-negative squares atomically.
__device__ inline void keep_largest(double* largest, double square) {
  atomicMax(reinterpret_cast<unsigned long long*>(largest),
            static_cast<unsigned long long>(__double_as_longlong(square)));
}

/// Adds a block's counts of ray statuses to the totals. Must be called by all threads of the block.
/// @param counts  [pulse][status]
__device__ inline void add_ends(ParticlesLaunch const& launch, unsigned int const* counts, unsigned long long* ends) {
  __syncthreads();
  if (threadIdx.x < frame_count * ray_status_count && counts[threadIdx.x] > 0) {
    auto const more = static_cast<long long>(counts[threadIdx.x]);
    // negative counts rely on unsigned wrap-around
    atomicAdd(ends + threadIdx.x, static_cast<unsigned long long>(launch.sign < 0 ? -more : more));
  }
}

}  // namespace gladstone::cuda::inline rays
